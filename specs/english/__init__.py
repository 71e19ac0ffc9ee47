"""English: a lesson in words becomes the task that a YAML file would describe.

    text -- layout --> sentences -- words --> tokens -- parsing --> clauses -- meaning --> steps

`grammar.lark` and `vocabulary.yaml` hold the language, the modules here only what it needs to be
understood: who "it" is, what comes after what, and where a mistake stands.
"""
