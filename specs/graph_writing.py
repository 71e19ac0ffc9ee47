"""The task graph as Mermaid, DOT, GraphML and JSON.

The first three are pictures. The JSON is the whole task: `graph_reading` makes it a task again.
"""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import networkx as nx

from specs.graph import AFTER, OTHERWISE, WHILE, TaskGraph
from specs.writing import task_to_data

Claims = Mapping[str, Sequence[str]]  # of each sub-task, the parts of the body that it claims
NO_CLAIMS: Claims = {}
ORDER = (AFTER, OTHERWISE, WHILE)  # keys of a sub-task that a graph writes as edges

NOT_YAML = re.compile("[\x7f-\xa0\u2028\u2029\ufeff\ufffe\uffff]")  # in JSON, but not as it is
NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
NOT_MERMAID = re.compile('[#<>"`\\\\]')


def to_mermaid(task: TaskGraph, claims: Claims = NO_CLAIMS) -> str:
    """The graph as a Mermaid flowchart."""
    ids = _ids(task)
    lines = ["flowchart TD"]
    for name in task.order:
        said = (NOT_MERMAID.sub(_entity, line) for line in _label(task, name, claims))
        lines.append(f'    {ids[name]}["{"<br>".join(said)}"]')
    arrow = {AFTER: "-->", OTHERWISE: "-. otherwise .->", WHILE: "-. while .->"}
    for one, then, kind in task.edges:
        lines.append(f"    {ids[one]} {arrow.get(kind, f'-->|{kind}|')} {ids[then]}")
    return "\n".join(lines) + "\n"


def to_dot(task: TaskGraph, claims: Claims = NO_CLAIMS) -> str:
    """The graph in Graphviz' DOT language."""
    ids = _ids(task)
    lines = [f"digraph {_quoted(task.spec.task)} {{", "    node [shape=box];"]
    for name in task.order:
        label = "\\n".join(_quoted(line)[1:-1] for line in _label(task, name, claims))
        lines.append(f'    {ids[name]} [label="{label}"];')
    for one, then, kind in task.edges:
        dashed = " style=dashed" if kind in (OTHERWISE, WHILE) else ""
        more = "" if kind == AFTER else f' [label="{kind}"{dashed}]'
        lines.append(f"    {ids[one]} -> {ids[then]}{more};")
    return "\n".join([*lines, "}"]) + "\n"


def to_graphml(task: TaskGraph, claims: Claims = NO_CLAIMS) -> str:
    """The graph as GraphML, for other programs; the keys of nodes are those of the JSON."""
    spec = task.spec
    graph: nx.DiGraph[str] = nx.DiGraph(
        task=spec.task, title=_xml(spec.title), tempo=spec.tempo, duration=task.duration
    )
    for name, planned in _planned(task, claims).items():
        does = task.subtasks[name].does
        about = {
            "words": _xml(task.subtasks[name].words),
            "primitive": does.kind,
            "controller": str(getattr(does, "controller", "")),
            **planned,
            "claims": ", ".join(claims.get(name, ())),
        }
        graph.add_node(name, **{key: value for key, value in about.items() if value != ""})
    for one, then, kind in task.edges:
        graph.add_edge(one, then, kind=kind)
    return "\n".join(nx.generate_graphml(graph)) + "\n"


def to_json(task: TaskGraph, claims: Claims = NO_CLAIMS) -> str:
    """The whole task as JSON, its order as edges; `adonis run` takes it like a task file.

    Nodes have the keys of a sub-task but for `after`, `otherwise` and `while`, which the edges
    say. `planned` follows from the rest: start and end [s], claims, conditions in words.
    """
    whole = task_to_data(task.spec)
    nodes = [
        {key: value for key, value in subtask.items() if key not in ORDER}
        for subtask in whole.pop("subtasks")
    ]
    edges = [
        {"from": one, "to": then} | ({} if kind == AFTER else {"kind": kind})
        for one, then, kind in task.edges
    ]
    whole |= {"nodes": nodes, "edges": edges, "planned": _planned(task, claims)}
    text = json.dumps(whole, indent=2, ensure_ascii=False) + "\n"
    return NOT_YAML.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def _planned(task: TaskGraph, claims: Claims) -> dict[str, dict[str, Any]]:
    """What follows for each sub-task."""
    found: dict[str, dict[str, Any]] = {}
    for name in task.order:
        start, end = task.planned[name]
        found[name] = {"start": round(start, 6), "end": round(end, 6)}
        if name in claims:
            found[name]["claims"] = list(claims[name])
        if circumstances := task.subtasks[name].circumstances:
            found[name]["circumstances"] = circumstances
    return found


def _ids(task: TaskGraph) -> dict[str, str]:
    """Names that every language takes."""
    return {name: f"s{i}" for i, name in enumerate(task.order)}


def _label(task: TaskGraph, name: str, claims: Claims) -> list[str]:
    """What a box says, line by line."""
    subtask, (start, end) = task.subtasks[name], task.planned[name]
    said = " ".join(subtask.words.split()) or name
    own = ", ".join(claims.get(name, ())).replace("_", " ")
    lines = [said, f"{subtask.does.kind}, {start:.2f}-{end:.2f} s", own, subtask.circumstances]
    return [line for line in lines if line]


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _entity(found: "re.Match[str]") -> str:
    """A character that Mermaid would read as its own."""
    return f"#{ord(found[0])};"


def _xml(text: str) -> str:
    """The text without what XML cannot hold."""
    return NOT_XML.sub("\ufffd", text)
