"""Bodies on the terminal: proposing one for a model, and saying what one is and lacks."""

import os
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from adonis.errors import OutputError
from adonis.lacking import lacks_of
from adonis.reporting import prepare_file, write_text
from sim import Body, BodyFile, NoDisplay, Proposal, body_name, propose, read_model, render_portrait
from specs import body_text, find_body, is_body_file, read_body_file

GUESSED = "# guessed"
DOUBTFUL = "DOUBTFUL"


def propose_and_write(
    console: Console, model: Path, out: Path | None, *, name: str | None, force: bool
) -> None:
    """Write a body file for a model, and its picture.

    Args:
        console: where it is told what was found.
        model: the file of the model.
        out: the body file.
        name: of the body; default: after the model.
        force: whether a body file that exists is written over.

    Raises:
        BodyError: the model cannot be read, or has nothing like an arm.
        OutputError: the file cannot be written.
    """
    called = name or body_name(model)
    file = out or Path(f"{called}.body.yaml")
    if file.exists() and not force:
        raise OutputError(f"{file} is there already: give --force to write over it, or --out")
    source = read_model(model)
    proposal = propose(source, called, _seen_from(model, file))
    picture = file.with_name(file.name.removesuffix(".yaml") + ".png")
    prepare_file(file)
    text = body_text(proposal, picture.name)
    write_text(file, text)
    body = find_body(str(file))
    _tell_of(console, proposal, text)
    written = [str(file), *_draw(console, body, picture)]
    _print_lacks(console, body)
    console.print(f"Written: [bold]{escape(', '.join(written))}[/bold]", soft_wrap=True)
    console.print(
        f"Look at the picture, mend the file, then: adonis body check {escape(str(file))}",
        soft_wrap=True,
    )


def check_body(console: Console, name: str, picture: Path | None) -> bool:
    """Print what a body is and lacks.

    Args:
        console: where it is printed.
        name: a body of the package, or a body file.
        picture: where to draw it.

    Returns:
        Whether it lacks nothing.

    Raises:
        SpecError: there is no such body, or its file makes no sense.
        OutputError: the picture cannot be written.
    """
    body = find_body(name)
    file = read_body_file(name)[0] if is_body_file(name) else None
    _print_joints(console, body, file)
    if file is not None:
        guesses = Path(name).read_text(encoding="utf-8").count(GUESSED)
        if guesses:
            console.print(f"{guesses} things in {escape(name)} are marked as guessed.")
    if picture is not None:
        prepare_file(picture)
        _draw(console, body, picture)
    return _print_lacks(console, body)


def _tell_of(console: Console, proposal: Proposal, text: str) -> None:
    """What was found in a model, and how sure that is."""
    file = proposal.file
    table = Table("part", "joints of the model", title=file.body, title_justify="left")
    parts = {"waist": file.waist, "neck": file.neck}
    parts |= {name.replace("_", " "): limb.joints for name, limb in file.limbs.items()}
    for part, joints in parts.items():
        table.add_row(part, ", ".join(of.joint for of in joints.values()) or "[dim]none[/dim]")
    console.print(table)
    faces = proposal.notes.get(("base", "forward"), "")
    said = f"It faces {file.base.forward} of the model ({faces}), {file.base.up} is up."
    console.print(escape(said), style="yellow" if DOUBTFUL in said else None, soft_wrap=True)
    console.print(f"{text.count(GUESSED)} things were guessed and are marked in the file.")
    for note in proposal.said:
        console.print(f"[dim]{escape(note)}[/dim]", soft_wrap=True)


def _print_joints(console: Console, body: Body, file: BodyFile | None) -> None:
    """A table of the joints: what they are called, and what the model calls them."""
    old: dict[str, tuple[str, str]] = {}
    if file is not None:
        for limb in file.limbs.values():
            for name, of in limb.joints.items():
                flip = " flipped" if of.flipped else ""
                old[f"{limb.side}_{name}"] = old[name] = (of.joint + flip, f"{of.zero:g}")
        for name, of in (*file.waist.items(), *file.neck.items()):
            old[name] = (of.joint + (" flipped" if of.flipped else ""), f"{of.zero:g}")
    table = Table(
        title=body.map.name, title_justify="left", caption_justify="left",
        caption="range in degrees, torque in N m, servo in N m/rad, fastest in degrees/s",
    )  # fmt: skip
    table.add_column("joint", no_wrap=True)
    if file is not None:
        table.add_column("in the model")
        table.add_column("zero at")
    for column in ("range", "torque", "servo", "fastest"):
        table.add_column(column, no_wrap=True)
    for dof in range(body.nv):
        name = body.dof_name(dof)
        low, high = (np.rad2deg(limit[dof]) for limit in body.range)
        row = [name, f"{low:z.0f} to {high:z.0f}", _short(body.torque_limit[dof])]
        servo = body.map.servos.get(name)
        row.append(_short(servo.stiffness) if servo else "-")
        row.append(f"{np.rad2deg(body.speed_limit[dof]):.0f}")
        if file is not None:
            row[1:1] = old.get(name, ("", ""))
        table.add_row(*row)
    console.print(table)


def _short(number: float) -> str:
    """Three digits are enough."""
    return f"{number:.3g}" if number < 1000.0 else f"{number:.0f}"


def _print_lacks(console: Console, body: Body) -> bool:
    """What it lacks; returns whether that is nothing."""
    lacks = lacks_of(body)
    for lack in lacks:
        console.print(f"[yellow]{escape(lack.what)}[/yellow]: {escape(lack.cost)}", soft_wrap=True)
    if not lacks:
        console.print("It lacks nothing that tasks may need.")
    return not lacks


def _draw(console: Console, body: Body, picture: Path) -> list[str]:
    """Draw a body; returns the file, if this machine can draw."""
    try:
        render_portrait(body, picture)
    except NoDisplay as problem:
        console.print(f"[yellow]{escape(str(problem))}[/yellow]", soft_wrap=True)
        return []
    return [str(picture)]


def _seen_from(model: Path, file: Path) -> str:
    """The path of a model as a body file is to name it."""
    folder = file.parent.resolve()
    try:
        return Path(os.path.relpath(model.resolve(), folder)).as_posix()
    except ValueError:  # on another drive
        return str(model.resolve())
