"""A proposal for a body as YAML, with what was guessed marked beside it."""

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from sim import Proposal
from specs.editing import on_one_line

HEAD = """\
# What the parts of {model} are called in anatomy, so that it can do tasks.
# Written by `adonis body new`; yours to change. What is marked as guessed may be wrong: look at
# {picture}, mend it here, and see what `adonis body check` says.
"""
JOINTS = """\
# Joints that move, from the trunk outwards; all others stay where they are. `zero` is the angle of
# the model's joint when the arm hangs straight with its palm to the thigh [deg]; a `flipped` one
# grows as the model's falls. What has no name in anatomy keeps its own. Guessed: all names, by the
# way the axes lie then.
"""
PLACES = """\
# Places are forward, left and up of their link's origin while the arms hang straight [m]. The
# origins of an arm's links are shoulder, elbow and wrist; the trunk's is below the shoulders.
"""
WIDE = 100  # of a line, before what was guessed is said above it


def body_text(proposal: Proposal, picture: str) -> str:
    """The text of a body file.

    Args:
        proposal: what was guessed.
        picture: the file that shows it.
    """
    file, notes = proposal.file, proposal.notes
    lines = [HEAD.format(model=file.model, picture=picture).rstrip(), ""]
    lines += [f"# {said}." for said in proposal.said]
    lines += [""] if proposal.said else []
    data = file.model_dump(mode="json", exclude_defaults=True, by_alias=True)
    lines += [f"body: {_flow(file.body)}", f"model: {_flow(file.model)}", "", "base:"]
    base = {"forward": file.base.forward, "up": file.base.up, "height": file.base.height}
    lines += [_line(key, value, 2, notes.get(("base", key))) for key, value in base.items()]
    lines += ["", JOINTS.rstrip(), f"trunk: {_flow(file.trunk)}"]
    for part in ("waist", "neck"):
        lines += _joints(part, data.get(part, {}), 0, notes)
    if file.head is not None:
        lines.append(_line("head", data["head"], 0, "guessed"))
    lines.append("limbs:")
    for name, limb in data["limbs"].items():
        lines += [f"  {name}:", f"    side: {limb['side']}"]
        lines += _joints("joints", limb["joints"], 4, notes, notes.get(("limbs", name, "joints")))
        lines.append(_line("palm", limb["palm"], 4, notes.get(("limbs", name, "palm"))))
    for part, note in (("locked", None), ("masses", notes.get(("masses",)))):
        if data.get(part):
            lines += ["", _line(part, data[part], 0, note)]
    lines += ["", "postures:"]
    lines += [_line(name, value, 2, "guessed") for name, value in data["postures"].items()]
    lines += ["", PLACES.rstrip(), "landmarks:  # guessed: by rays cast at the shapes"]
    lines += [_line(name, value, 2) for name, value in data.get("landmarks", {}).items()]
    said = notes.get(
        ("shapes",), "guessed: fitted to what collides in the model, else to what is drawn"
    )
    lines += ["", f"shapes:  # capsules that collide; {said}"]
    for link, shapes in data.get("shapes", {}).items():
        lines.append(f"  {_flow(link)}:")
        lines += [f"    - {_flow(shape)}" for shape in shapes]
    if file.may_overlap:
        lines += ["", "may_overlap:  # guessed: links that are in each other at rest, or mostly"]
        lines += [f"  - {_flow(list(pair))}" for pair in file.may_overlap]
    return "\n".join(lines) + "\n"


def _joints(
    key: str,
    joints: Mapping[str, Any],
    indent: int,
    notes: Mapping[tuple[str, ...], str],
    note: str | None = None,
) -> list[str]:
    """The joints of one part, each on its line, with what was filled in."""
    space = " " * indent
    if not joints:
        return [f"{space}{key}: {{}}  # none was found"]
    lines = [f"{space}{key}:" + (f"  # {note}" if note else "")]
    for name, of in joints.items():
        lines.append(_line(name, of, indent + 2, notes.get(("joint", of["joint"]))))
    return lines


def _line(key: str, value: object, indent: int, note: str | None = None) -> str:
    """A key and its value in one line, and a comment behind or above it."""
    space = " " * indent
    line = f"{space}{_flow(key)}: {_flow(value)}"
    if not note:
        return line
    if len(line) + len(note) + 4 <= WIDE:
        return f"{line}  # {note}"
    return f"{space}# {note}\n{line}"


def _flow(value: object) -> str:
    """A value on one line."""
    if isinstance(value, BaseModel):
        value = value.model_dump(mode="json", exclude_defaults=True, by_alias=True)
    return on_one_line(value)
