"""Floor 3: the task language, from YAML to a bound task graph."""

from specs.available import available_primitives, primitives_in
from specs.best_effort import BestEffort
from specs.binding import BoundTask, bind_task
from specs.body_loading import find_body, is_body_file, read_body_file, source_of
from specs.body_writing import body_text
from specs.claims import claims_of
from specs.conditions import Condition, Join, Repeat
from specs.controllers import load_variant, with_controller, with_parameter
from specs.editing import GONE, places_of_steps, set_values, write_back
from specs.errors import Position, SpecError
from specs.firmness import Firmness
from specs.fitness import Fitness, fitness_of
from specs.fitting import Fit, fit_of, fitted, refitted, resized, slowed
from specs.graph import TaskGraph, build_graph
from specs.graph_writing import to_dot, to_graphml, to_json, to_mermaid
from specs.groups import Group
from specs.lint import KINDS, Finding, lint_task, refusal
from specs.loading import find_task, library, load_task, task_from_text
from specs.reading import Document
from specs.reference import reference
from specs.schema import SHIPPED_SCHEMA, task_schema
from specs.task import Background, SubTask, TaskSpec, with_tempo
from specs.validating import read_checked
from specs.writing import task_to_data, task_to_yaml

__all__ = [
    "GONE",
    "KINDS",
    "SHIPPED_SCHEMA",
    "Background",
    "BestEffort",
    "BoundTask",
    "Condition",
    "Document",
    "Finding",
    "Firmness",
    "Fit",
    "Fitness",
    "Group",
    "Join",
    "Position",
    "Repeat",
    "SpecError",
    "SubTask",
    "TaskGraph",
    "TaskSpec",
    "available_primitives",
    "bind_task",
    "body_text",
    "build_graph",
    "claims_of",
    "find_body",
    "find_task",
    "fit_of",
    "fitness_of",
    "fitted",
    "is_body_file",
    "library",
    "lint_task",
    "load_task",
    "load_variant",
    "places_of_steps",
    "primitives_in",
    "read_body_file",
    "read_checked",
    "reference",
    "refitted",
    "refusal",
    "resized",
    "set_values",
    "slowed",
    "source_of",
    "task_from_text",
    "task_schema",
    "task_to_data",
    "task_to_yaml",
    "to_dot",
    "to_graphml",
    "to_json",
    "to_mermaid",
    "with_controller",
    "with_parameter",
    "with_tempo",
    "write_back",
]
