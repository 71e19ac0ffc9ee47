"""The vocabulary for readers: a page of it, and what one word means."""

from collections.abc import Iterator, Mapping
from typing import Any

from specs.english.lexing import classes
from specs.english.vocabulary import CLASSES, FILLER, Entry, vocabulary

WHO = {
    "arm": "an arm or hand",
    "both": "both arms",
    "elbow": "an elbow",
    "palm": "a palm",
    "place": "a place",
    "thing": "a thing",
    "nothing": "nothing",
}
DONE = {
    "arm": "get-posture: the arm in a direction",
    "rest": "get-posture: the arm at rest",
    "elbow": "get-posture: the elbow alone",
    "palm": "get-posture: the arm as it was, the palm turned",
    "reach": "go-to-point; to the other hand: follow",
    "gather": "go-to-point, in front of the chest",
    "reach_to": "go-to-point",
    "cross": "go-to-point, one hand after the other",
    "press": "go-to-point, palm to palm",
    "tap": "go-to-point, off the place and on again, so many times",
    "clap": "go-to-point, apart and together, so many times",
    "relax": "relax",
    "hold": "hold",
    "turn": "get-posture of",
    "turns": "get-posture, one after the other, of",
    "rhythm": "oscillate:",
    "look": "look-at",
    "point": "point-at",
    "follow": "follow",
    "wait": "hold of waist and neck",
    "home": "get-posture: rest, all of the body",
    "repeat": "sentences once more",
}
TITLES = {
    "nouns": "Parts of the body",
    "prepositions": "Where",
    "directions": "Which way",
    "manners": "How",
    "units": "Units",
    "links": "What comes after what",
    "signals": "What can be waited for",
}


def reference() -> str:
    """The vocabulary as a page of Markdown."""
    data = vocabulary().data
    lines = ["### Verbs", "", "| words | said of | with | becomes |", "|---|---|---|---|"]
    for verb in data["verbs"].values():
        words = ", ".join(verb["words"])
        for sense in verb["senses"]:
            said = WHO.get(sense["of"], f"the {sense['of']}")
            lines.append(f"| {words} | {said} | {sense.get('with', '')} | {_becomes(sense)} |")
            words = ""
    for section, title in TITLES.items():
        lines += ["", f"### {title}", "", "| words | meaning |", "|---|---|"]
        for key, meaning in data[section].items():
            told = _told(Entry(CLASSES[section], key, meaning))
            lines.append(f"| {', '.join(meaning['words'])} | {told} |")
    lines += ["", "### Without effect", "", ", ".join(sorted(data["fillers"])) + "."]
    lines += ["", "### Understood, but not possible", "", "| words | why not |", "|---|---|"]
    for cannot in data["cannot"].values():
        lines.append(f"| {', '.join(cannot['words'])} | {cannot['why']} |")
    return "\n".join(lines) + "\n"


def meanings(words: str) -> list[str]:
    """What some words mean, one sentence for each meaning; nothing if they are not known."""
    found: list[str] = []
    for entry in vocabulary().entries.get(" ".join(words.lower().split()), ()):
        if entry.kind == "VERB":
            found += list(_senses(entry))
        else:
            found.append(f"{_kind(entry)}: {_told(entry)}")
        same = [w for w in entry.meaning.get("words", ()) if w != words.lower()]
        if same:
            found.append(f"    the same: {', '.join(same)}")
    return found


def _senses(entry: Entry) -> Iterator[str]:
    for sense in entry.meaning["senses"]:
        said = WHO.get(sense["of"], f"the {sense['of']}")
        beside = f" with a {sense['with']}" if "with" in sense else ""
        yield f"verb, said of {said}{beside}: {_becomes(sense)}"


def _becomes(sense: Mapping[str, Any]) -> str:
    done = DONE[sense["does"]]
    match sense["does"]:
        case "turn" | "turns":
            ways = vocabulary().data["ways"][sense["ways"]]
            known = ", ".join(way for way in ways if way not in ("joints", "straight"))
            return f"{done} the {ways['joints']} ({known})"
        case "rhythm":
            swing = vocabulary().data["rhythms"][sense["rhythm"]]
            return f"{done} {', '.join(swing['joints'])}, {swing['beats']:g} beats each".replace(
                "{side}_", ""
            )
        case "reach_to" | "cross":
            return f"{done}, to {sense['to']}"
        case "elbow":
            return f"{done}, {sense['degrees']} degrees"
        case "arm":
            way = f", {sense['arm']}" if "arm" in sense else ""
            return f"{done}{way}" + (", palm the same way" if "palm" in sense else "")
        case "relax" if sense.get("limp"):
            return f"{done}, limp"
    return done


def _kind(entry: Entry) -> str:
    return classes().get(entry.kind, entry.kind.lower()).removeprefix("a ")


def _told(entry: Entry) -> str:
    """What an entry says beside its words."""
    meaning = entry.meaning
    match entry.kind:
        case "NOUN":
            return _noun(meaning)
        case "PREPOSITION":
            return f"out from it, {meaning['way']}" if "way" in meaning else entry.key
        case "MANNER":
            what = "takes {:g} times as long" if "time" in meaning else "{:g} times as wide"
            return what.format(meaning.get("time", meaning.get("size")))
        case "UNIT":
            parts = [
                f"{meaning[key]:g} {key}"
                for key in ("beats", "seconds", "metres")
                if key in meaning
            ]
            return parts[0] if parts else entry.key
        case "SIGNAL":
            return f"event {entry.key}"
        case "CANNOT":
            return f"cannot be done: {meaning['why']}"
        case kind if kind == FILLER:
            return "has no effect"
    return entry.key


def _noun(meaning: Mapping[str, Any]) -> str:
    if "point" in meaning:
        return f"the point {meaning['point']}"
    parts = dict(meaning.get("parts", {}))
    told = [str(meaning["place"])] if "place" in meaning else []
    told += [
        f"{part} of: {place}" for part, place in parts.items() if place != meaning.get("place")
    ]
    if "opposite" in meaning:
        told.append(f"to the hand of the other side: {meaning['opposite']}")
    return "; ".join(told) or str(meaning["is"])
