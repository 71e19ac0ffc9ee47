"""Damaged task files, by the thousand: each is read or refused, soon, and nothing else happens.

    python -m tests.fuzz_yaml --count 100000 --processes 2

Python's audit hook watches what a file makes the program do: open a file that is not in the
task's folder, run a command, compile or import code. A file takes at most a second of processor
time, and memory does not grow beyond a bound.
"""

import argparse
import json
import multiprocessing
import random
import resource
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from sim import Body, adonis
from specs import (
    SpecError,
    bind_task,
    build_graph,
    library,
    load_task,
    task_from_text,
    task_to_yaml,
)

SLOWEST = 1.0  # processor time for one file [s]
MOST_MEMORY = 600_000  # that a process may grow by [kB]
BIND_EVERY = 10  # files; to bind takes longer than to read
FORBIDDEN = (
    "exec",
    "compile",
    "import",
    "os.system",
    "os.exec",
    "os.posix_spawn",
    "os.fork",
    "subprocess.Popen",
    "socket.connect",
    "ctypes.dlopen",
    "shutil.rmtree",
    "os.remove",
)

PARTS = """\
# What several tasks share.
background:
  - {name: weight, primitive: compensate-gravity}
landmarks:
  nose: {near: head.front, away: 0.02, offset: [0, 0, -0.03]}
fragments:
  tap:
    parameters: {limb: , place: , pause: 1}
    subtasks:
      - {name: go, words: Tap $place, primitive: go-to-point, limb: $limb, to: $place}
      - {name: back, primitive: get-posture, limb: $limb, posture: rest, beats: $pause}
"""
RICH = """\
task: rich
tempo: 90
tempo_map: [{beat: 2, tempo: 120}, {subtask: two, tempo: 60.5}]
include: [parts/moves.yaml]
landmarks:
  heart: {between: [chest.front, left_ribs]}
postures:
  ready: {from: rest, right_arm: {arm: forward, palm: up}, neck_y: 10}
fragments:
  both:
    parameters: {place: , speed: 1}
    subtasks:
      - {name: l, fragment: tap, with: {limb: left_arm, place: $place, pause: $speed}}
      - {name: r, fragment: tap, with: {limb: right_arm, place: $place}, after: []}
groups:
  - {name: all, rule: sum, members: [one, nod]}
subtasks:
  - {name: one, fragment: tap, with: {limb: right_arm, place: heart}}
  - {name: two, fragment: both, with: {place: &p head.top, speed: 0.5}, after: {any: [one]}}
  - {name: nod, primitive: get-posture, joints: [neck_y], posture: {neck_y: 10}}
  - name: end
    words: "Look, \\u00e9 'twas $5"
    primitive: go-to-point
    limb: right_arm
    to: {near: *p, away: 0.1, offset: [0.1, -2.0e-2, 0]}
    done: {near: nose, limb: right_arm, distance: 0.04}
    timeout: 2
    otherwise: home
  - {name: home, primitive: get-posture, limb: right_arm, posture: ready, seconds: 0x10}
  - {name: sway, primitive: oscillate, joints: {waist_x: {amplitude: 8}}, beats_per_cycle: 2,
     beats: 4, repeat: 2}
"""
TOKENS = [
    "{",
    "}",
    "[",
    "]",
    ":",
    "-",
    "&a ",
    "*a",
    "&p ",
    "*p",
    "!!int ",
    "!!python/object/apply:os.system ",
    "!!binary ",
    "null",
    ".nan",
    "-1",
    "1e999",
    "-.inf",
    "''",
    "|\n",
    "\t",
    "\n",
    "  ",
    "#",
    "%",
    "@",
    "right_arm",
    "to",
    "via",
    "after",
    "primitive",
    "0x10",
    "\x07",
    "- name: x\n",
    "~",
    "2026-11-22",
    "yes",
    "<<: ",
    "? ",
    ">",
    "é",
    "💃",
    "\x85",
    "\u2028",
    "\ufeff",
    "---\n",
    "...\n",
    "%YAML 1.1\n",
    "1_000",
    "1:30",
    "$limb",
    "${place}",
    "$$",
    "$",
    "$__class__",
    "{{7*7}}",
    "__import__('os')",
    "fragment: both",
    "with: ",
    "include: [../secret.yaml]",
    "include: [link.yaml]",
    "include: [loop.yaml]",
    "include: [/etc/passwd]",
    "parts/../../secret.yaml",
    "linked/secret.yaml",
    "link.yaml",
    "loop.yaml",
    "/dev/zero",
    "parts",
    ".",
    "from: ready",
    "between: [heart, nose]",
    "subtask: nod",
    "beat: 1e9",
    "repeat: 1000000",
    "9" * 400,
    "a" * 3000,
    "[" * 60,
    "{a: " * 60,
    "tempo: 1000",
    "first: [one, two]",
    "while: one",
    "otherwise: two",
]


@dataclass
class Result:
    """What became of some files."""

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0  # processor time [s]
    grown: int = 0  # memory [kB]
    faults: list[str] = field(default_factory=list)


class Watch:
    """What the program does while it reads a file."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.on = str(folder.resolve()), False
        self.seen: list[str] = []
        sys.addaudithook(self._saw)

    def _saw(self, event: str, arguments: tuple[object, ...]) -> None:
        if not self.on:
            return
        if event == "open":
            path = str(Path(str(arguments[0])).absolute())
            if not path.startswith(self.folder) or "secret" in path:
                self.seen.append(f"open {path}")
        elif event.startswith(FORBIDDEN):
            self.seen.append(f"{event} {str(arguments)[:80]}")


def mutated(rng: random.Random, text: str) -> str:
    """Cut, doubled, spliced and peppered with what YAML finds interesting."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        j = min(j, i + rng.choice((3, 30, 300)))
        token = rng.choice(TOKENS)
        match rng.randrange(7):
            case 0:
                text = text[:i] + text[j:]
            case 1:
                text = text[:j] + text[i:j] * rng.choice((1, 1, 8)) + text[j:]
            case 2:
                text = text[:i] + token + text[i:]
            case 3:
                text = text[:i] + token + text[j:]
            case 4:
                k = rng.randrange(len(text) + 1)
                text = text[:k] + text[i:j] + text[k:]
            case 5:
                words = text.split(" ")
                words[rng.randrange(len(words))] = rng.choice([token, rng.choice(words)])
                text = " ".join(words)
            case 6:
                lines = text.split("\n")
                rng.shuffle(lines) if rng.random() < 0.1 else lines.insert(
                    rng.randrange(len(lines)), " " * rng.randrange(8) + token
                )
                text = "\n".join(lines)
    return text


def bomb(rng: random.Random) -> str:
    """Something that grows when it is followed: aliases, fragments, arguments, texts."""
    n, width = rng.randint(5, 60), rng.randint(2, 12)
    step = "{name: s, primitive: compensate-gravity}"
    match rng.randrange(5):
        case 0:
            lines = [f"a0: &a0 [{', '.join(['x'] * width)}]"]
            lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * width)}]" for k in range(1, n)]
        case 1:
            lines = ["task: x", f"subtasks: [{{name: u, fragment: f{n}}}]", "fragments:",
                     f"  f0: {{subtasks: [{step}]}}"]  # fmt: skip
            for k in range(1, n + 1):
                uses = ", ".join(f"{{name: u{j}, fragment: f{k - 1}}}" for j in range(width))
                lines.append(f"  f{k}: {{subtasks: [{uses}]}}")
        case 2 | 3 as kind:
            grown = "$a" * width if kind == 2 else f"[{', '.join(['$a'] * width)}]"
            lines = [
                "task: x",
                f"subtasks: [{{name: u, fragment: f{n}, with: {{a: b}}}}]",
                "fragments:",
                "  f0: {parameters: {a: }, subtasks: [{name: s, words: $a}]}",
            ]
            for k in range(1, n + 1):
                use = f"{{name: u, fragment: f{k - 1}, with: {{a: {grown}}}}}"
                lines.append(f"  f{k}: {{parameters: {{a: }}, subtasks: [{use}]}}")
        case _:
            lines = ["task: x", "tempo_map:"]
            lines += [f"- {{subtask: s{k}, tempo: {rng.randint(1, 1000)}}}" for k in range(n)]
            lines += ["subtasks:"]
            lines += [f"- {{name: s{k}, primitive: hold, limb: right_arm, seconds: {k + 1}}}"
                      for k in range(n)]  # fmt: skip
    return "\n".join(lines)


def prepare(folder: Path) -> Path:
    """A task's folder with what it may include, and beside it what it may not."""
    top = folder / "task"
    (top / "parts").mkdir(parents=True)
    (top / "parts" / "moves.yaml").write_text(PARTS)
    (top / "loop.yaml").write_text("include: [parts/../loop.yaml, loop.yaml]\n")
    (folder / "secret.yaml").write_text("postures: {secret: {from: rest}}\n")
    (top / "link.yaml").symlink_to(folder / "secret.yaml")
    (top / "linked").symlink_to(folder)
    return top


def fuzz(seed: int, count: int, patience: float) -> Result:
    """Read damaged files.

    Args:
        seed: of all that is random.
        count: how many.
        patience: processor time that each may take [s].
    """
    rng, body, result = random.Random(seed), adonis(), Result()
    texts = [path.read_text(encoding="utf-8") for path in library().values()]
    texts = [RICH] * (3 * len(texts)) + [t for t in texts if len(t) < 6000]
    with tempfile.TemporaryDirectory() as temporary:
        top = prepare(Path(temporary))
        file = top / "task.yaml"
        file.write_text(RICH)
        for task in (file, *library()):  # imports and caches come before the watch
            spec, document = load_task(task)
            bind_task(spec, body, document)
        watch = Watch(top)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for number in range(count):
            text = bomb(rng) if rng.random() < 0.01 else mutated(rng, rng.choice(texts))
            file.write_bytes(text.encode("utf-8", "surrogatepass"))
            took = one(file, body, result, watch, bind=number % BIND_EVERY == 0)
            result.slowest = max(result.slowest, took)
            if took > patience:
                result.faults.append(f"{took:.2f} s:\n{text[:3000]}")
        result.grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    if result.grown > MOST_MEMORY:
        result.faults.append(f"memory grew by {result.grown} kB")
    return result


def one(file: Path, body: Body, result: Result, watch: Watch, *, bind: bool) -> float:
    """Read one file, bind what it says, and write it again; how long reading took [s]."""
    start, watch.on = time.process_time(), True
    try:
        spec, document = load_task(file)
        graph = build_graph(spec, document)
        outcome = "sound" if graph.duration >= 0.0 else "never ends"
        if bind:
            bind_task(spec, body, document)
    except SpecError as problem:
        outcome = "refused"
        if "\n" in str(problem) or not str(problem).startswith(str(file.parent)):
            result.faults.append(f"a message: {str(problem)!r}")
    except BaseException as problem:
        outcome = "raised"
        text = file.read_text(encoding="utf-8", errors="replace")
        result.faults.append(f"{type(problem).__name__}: {problem}\n{text}")
    watch.on = False
    took = time.process_time() - start
    if outcome == "sound" and bind and task_from_text(task_to_yaml(spec))[0] != spec:
        result.faults.append(f"written and read again it is another:\n{file.read_text()}")
    result.outcomes[outcome] += 1
    result.faults += [f"it did: {what}" for what in watch.seen]
    watch.seen.clear()
    return took


def main() -> None:
    """Print what became of them as JSON; ends with 1 if something went wrong."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--count", type=int, default=100_000)
    options.add_argument("--processes", type=int, default=2)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--patience", type=float, default=SLOWEST)
    asked = options.parse_args()
    each = asked.count // asked.processes
    shares = [(asked.seed + k, each, asked.patience) for k in range(asked.processes)]
    with multiprocessing.get_context("spawn").Pool(asked.processes) as pool:
        results = pool.starmap(fuzz, shares)
    faults = [fault for r in results for fault in r.faults]
    figures = {
        "files": sum(sum(r.outcomes.values()) for r in results),
        "outcomes": dict(sum((r.outcomes for r in results), Counter())),
        "slowest [s]": round(max(r.slowest for r in results), 3),
        "memory grown [MB]": round(max(r.grown for r in results) / 1000),
        "faults": len(faults),
    }
    print(json.dumps(figures, indent=2))
    for fault in faults[:20]:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
