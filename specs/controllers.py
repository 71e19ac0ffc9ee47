"""The same task by another controller: one word changes, and what belonged to the old one goes."""

from collections.abc import Iterable
from typing import get_args

from pydantic import ValidationError

from primitives import Primitive
from primitives.parameters import GAINS, OWN_PARAMETERS, Controller
from sim import unknown
from specs.errors import SpecError
from specs.loading import find_task, load_task
from specs.reading import Document
from specs.task import SubTask, TaskSpec


def with_controller(spec: TaskSpec, controller: str) -> TaskSpec:
    """A task with every sub-task that can be moved by any controller moved by this one.

    Sub-tasks that it moves already stay as they are. From the others, gains and whatever only
    some controllers have are taken away: what is left is the body's.

    Raises:
        SpecError: there is no such controller, or a sub-task cannot be done by it.
    """
    if controller not in get_args(Controller):
        raise SpecError(unknown("controller", controller, get_args(Controller)))
    return spec.model_copy(
        update={"subtasks": tuple(_swapped(s, controller) for s in spec.subtasks)}
    )


def _swapped(subtask: SubTask, controller: str) -> SubTask:
    does = subtask.does
    if getattr(does, "controller", controller) == controller:
        return subtask
    written = does.model_dump(exclude_unset=True)
    kept = {k: v for k, v in written.items() if k not in OWN_PARAMETERS and k not in GAINS}
    try:
        swapped = type(does).model_validate(kept | {"controller": controller})
    except ValidationError as problem:
        said = problem.errors()[0]["msg"].removeprefix("Value error, ")
        raise SpecError(f"{subtask.name}: {said}") from None
    return subtask.model_copy(update={"does": swapped})


def with_parameter(spec: TaskSpec, name: str, value: object) -> TaskSpec:
    """A task in which every sub-task that has some parameter has this value of it.

    Raises:
        ValidationError: it cannot have that value.
    """

    def changed(subtask: SubTask) -> SubTask:
        does = subtask.does
        if name not in type(does).model_fields:
            return subtask
        written = does.model_dump(exclude_unset=True) | {name: value}
        return subtask.model_copy(update={"does": type(does).model_validate(written)})

    return spec.model_copy(update={"subtasks": tuple(changed(s) for s in spec.subtasks)})


def load_variant(
    task: str, controller: str, *, primitives: Iterable[type[Primitive]] = ()
) -> tuple[TaskSpec, Document]:
    """A task by one controller: its own file for that controller if there is one.

    That of `macarena` by `pd-servo` is `macarena-pd-servo`, in the library or beside the
    task's file. Where there is none, the task itself is taken and its controllers swapped.

    Raises:
        SpecError: as `load_task` and `with_controller`.
    """
    path = find_task(task)
    own = path.with_name(f"{path.stem}-{controller}{path.suffix}")
    spec, document = load_task(own if own.exists() else path, primitives=primitives)
    return with_controller(spec, controller), document
