"""Which topics tell of bumps: by message type, by name, and if need be by what they say."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass

from mpap_cli.errors import UsageError
from mpap_cli.logs.bumps.bumpers import (
    BUMPER_RULES,
    BumpDecoder,
    BumperRule,
    apply_choice,
    parse_bump_topic,
)
from mpap_cli.logs.foxglove import FOXGLOVE_ENCODINGS
from mpap_cli.logs.listing import list_topics, messages_of, not_used, why_unread
from mpap_cli.logs.protobuf import PROTOBUF, boolean_fields
from mpap_cli.logs.raw import LogReader, PayloadError, Topic
from mpap_cli.params import BumperParams

BUMPER_NAME = re.compile(r"bump|collision|contact|hazard", re.IGNORECASE)
_TYPE_SCORE, _NAME_SCORE, _HELD_SCORE = 10, 3, 1
_BOOLEAN_FIELDS = ("pressed", "data")
_BOOLEAN_IN_TEXT = re.compile(r"^\s*bool(?:ean)?\s+(pressed|data)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class BumpRole:
    """A bump topic and what its messages say."""

    topic: Topic
    rule: BumperRule


BumpsFound = tuple[tuple[BumpRole, ...], str, tuple[str, ...], tuple[str, ...]]


def ask_for_bumps(reader: LogReader, words: tuple[str, ...]) -> BumpsFound:
    """Take the topics that ``--bump-topic`` names; try each on its first message.

    Raises
    ------
    UsageError
        If a topic is not there, its type is unknown and no expression is given, the
        expression does not fit the message, or pulses are mixed with other kinds.
    """
    roles = tuple(_ask_for_bump(reader, word) for word in words)
    if len({role.topic.name for role in roles}) < len(roles):
        msg = "--bump-topic: one topic is named twice; join the expressions with |"
        raise UsageError(msg)
    kinds = {role.rule.kind for role in roles}
    if "pulse" in kinds and len(kinds) > 1:
        msg = "--bump-topic: pulse topics cannot be joined with others; give :level or :edge=FIELD"
        raise UsageError(msg)
    return roles, "asked for", tuple(role.topic.name for role in roles), ()


def _ask_for_bump(reader: LogReader, word: str) -> BumpRole:
    choice = parse_bump_topic(word)
    start = f"{reader.path.name}: --bump-topic {word}"
    named = [topic for topic in reader.topics if topic.name == choice.topic]
    if not named:
        msg = f"{start}: no such topic; the log holds {list_topics(reader.topics)}"
        raise UsageError(msg)
    if all(map(why_unread, named)):
        msg = f"{start}: {why_unread(named[0])}"
        raise UsageError(msg)
    for topic in named:
        rule = apply_choice(
            _known_rule(topic) or _boolean_rule(reader, topic), topic.msgtype, choice
        )
        if rule is not None:
            role = BumpRole(topic, rule)
            next(_states(reader, role), None)
            return role
    msg = (
        f"{start}: {named[0].msgtype} is no bumper type that is known; say which field tells: "
        f"--bump-topic {choice.topic}:EXPR"
    )
    raise UsageError(msg)


def find_bumps(reader: LogReader) -> BumpsFound:
    """Take the topic that speaks most clearly of bumps; none is no error."""
    scores = {}
    for topic in reader.topics:
        role = _candidate(reader, topic)
        if role is not None:
            scores[role] = _score(role)
    ranked = sorted(scores, key=lambda role: (-scores[role], role.topic.name))
    notes = _notes(reader.topics, {role.topic.name for role in ranked})
    if not ranked:
        return (), "no bump topic; name one with --bump-topic TOPIC:EXPR", (), notes
    rivals = [role for role in ranked if _rivals(role, ranked[0], scores)]
    if len(rivals) > 1:
        best, why = _break_tie(reader, rivals)
    else:
        best = ranked[0]
        why = "the only bumper topic" if len(ranked) == 1 else "the best type and name"
    chosen = [best]
    if best.rule.all_topics:
        chosen += [r for r in ranked if r.topic.msgtype == best.topic.msgtype and r is not best]
    names = tuple(role.topic.name for role in ranked)
    if len(ranked) > len(chosen):
        why += f", of {', '.join(names)}; --bump-topic takes another"
    return tuple(chosen), why, names, notes


def _candidate(reader: LogReader, topic: Topic) -> BumpRole | None:
    """Tell what a topic would say of bumps, if it may be taken unasked."""
    named = bool(BUMPER_NAME.search(topic.name))
    rule = _known_rule(topic)
    if not (named or rule) or why_unread(topic):
        return None
    if rule is None and named and topic.encoding in FOXGLOVE_ENCODINGS:
        rule = _boolean_rule(reader, topic)
    if rule is None or rule.opt_in or (rule.needs_name and not named):
        return None
    if rule.kind == "level" and not topic.n_messages:
        return None  # no message of an event type means no touch; of a level, nothing
    return BumpRole(topic, rule)


def _score(role: BumpRole) -> int:
    """Add up type, name and messages."""
    return (
        _TYPE_SCORE * (role.rule.msgtype in BUMPER_RULES)
        + _NAME_SCORE * bool(BUMPER_NAME.search(role.topic.name))
        + _HELD_SCORE * bool(role.topic.n_messages)
    )


def _rivals(role: BumpRole, first: BumpRole, scores: dict[BumpRole, int]) -> bool:
    """Tell whether a topic is as good as the first, or the level stream of the same robot."""
    same_robot = role.topic.msgtype.split("/")[0] == first.topic.msgtype.split("/")[0]
    level_beside_event = role.rule.kind == "level" and first.rule.kind != "level" and same_robot
    return scores[role] == scores[first] or (level_beside_event and not role.rule.needs_name)


def _break_tie(reader: LogReader, rivals: list[BumpRole]) -> tuple[BumpRole, str]:
    """Decide by what the topics say; then level before event, switches before contacts."""
    fired = {role: _fires(reader, role) for role in rivals}
    order = (
        (lambda role: fired[role], "pressed at times"),
        (lambda role: role.rule.kind == "level", "tells the whole state in every message"),
        (lambda role: not role.rule.ignore_fields, "switches go before a simulator's contacts"),
    )
    left = rivals
    for is_better, why in order:
        better = [role for role in left if is_better(role)]
        if len(better) == 1:
            return better[0], why
        left = better or left
    return left[0], "the first by name of equals"


def _fires(reader: LogReader, role: BumpRole) -> bool:
    """Tell whether a topic is ever pressed; one that its rule does not fit is not."""
    try:
        return any(_states(reader, role))
    except UsageError:
        return False


def _states(reader: LogReader, role: BumpRole) -> Iterator[bool]:
    """Yield pressed or not for every message that can be decoded."""
    decoder = BumpDecoder(reader, role.rule, BumperParams())
    for group in reader.runs({role.topic.name}):
        for run in group.runs:
            if run.topic.msgtype == role.topic.msgtype:
                yield from (decoder(run)[0].codes % 2 == 1).tolist()


def _known_rule(topic: Topic) -> BumperRule | None:
    return BUMPER_RULES.get(topic.msgtype)


def _boolean_rule(reader: LogReader, topic: Topic) -> BumperRule | None:
    """Make a rule from a boolean field ``pressed`` or ``data``; of protobuf, the only one."""
    if topic.encoding == "json":
        name = _json_field(reader, topic)
    elif topic.encoding == PROTOBUF:
        name = _protobuf_field(topic)
    else:
        own_text = topic.definition.split("====")[0]
        match = _BOOLEAN_IN_TEXT.search(own_text)
        name = match[1] if match else None
    return BumperRule(topic.msgtype, "level", name) if name else None


def _json_field(reader: LogReader, topic: Topic) -> str | None:
    """Look for the field in the schema; without a schema, in the first message."""
    try:
        schema = json.loads(topic.definition or "{}")
    except ValueError:
        schema = {}
    properties = schema.get("properties", {}) if isinstance(schema, dict) else {}
    if properties:
        kinds = {name: kind for name, kind in properties.items() if isinstance(kind, dict)}
        return next((n for n in _BOOLEAN_FIELDS if kinds.get(n, {}).get("type") == "boolean"), None)
    try:
        decoded = next((reader.decode(message) for message in messages_of(reader, topic)), None)
    except PayloadError:
        decoded = None
    values = decoded if isinstance(decoded, dict) else {}
    return next((n for n in _BOOLEAN_FIELDS if isinstance(values.get(n), bool)), None)


def _protobuf_field(topic: Topic) -> str | None:
    """Look for the field in the schema."""
    names = boolean_fields(topic.definition, topic.msgtype)
    only = names[0] if len(names) == 1 else None
    return next((name for name in _BOOLEAN_FIELDS if name in names), only)


def _notes(topics: tuple[Topic, ...], used: set[str]) -> tuple[str, ...]:
    """Name topics that look like bumpers and are not taken."""
    notes = []
    for topic in topics:
        rule = _known_rule(topic)
        if topic.name in used or not (BUMPER_NAME.search(topic.name) or (rule and rule.opt_in)):
            continue
        if reason := why_unread(topic):
            notes.append(not_used(topic, reason))
            continue
        asked = topic.name if rule else f"{topic.name}:EXPR"
        notes.append(
            f"{topic.name} ({topic.msgtype}, {topic.n_messages} messages) is not taken as a "
            f"bumper unasked; --bump-topic {asked} takes it"
        )
    return tuple(notes)
