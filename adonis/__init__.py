"""Floor 5: the application. `adonis.run_task` dances a task; `adonis.judge` says how well."""

__version__ = "0.1.0"
