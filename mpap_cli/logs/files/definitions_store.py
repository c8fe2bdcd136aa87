"""Payloads become objects: a type is looked up when the first message of it is decoded.

A type is taken from the log, else from the folders of ``--msgs``, else from the definitions
that come with mpap, else from the standard types of the ROS distribution.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mpap_cli.errors import LogError, UsageError
from mpap_cli.logs.files.definition_texts import (
    BAD_DEFINITION,
    built_in,
    parse,
    standard_types,
    type_names,
    type_of,
)
from mpap_cli.logs.protobuf import (
    NO_SCHEMA,
    PROTOBUF,
    PROTOBUF_EXTRA,
    has_schema,
    protobuf_is_read,
    read_protobuf,
)
from mpap_cli.logs.raw import PayloadError, RawMessage, Topic

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

Decode = Callable[[bytes], object]

_ROS_ENCODINGS = frozenset({"ros1", "cdr"})
_MOST_STORES = 256
_STORES: "dict[tuple[object, ...], Typestore]" = {}


class DefinitionsStore:
    """Decodes the messages of one log.

    Parameters
    ----------
    log : str
        Base name of the log, for errors.
    msgs : sequence of Path
        Folders with ``.msg`` and ``.idl`` files, searched with all their subfolders.
    ros_distro : str
        Where the standard types come from; unknown or empty: humble.

    Raises
    ------
    UsageError
        If a folder does not exist.
    """

    def __init__(self, log: str, msgs: Sequence[Path] = (), ros_distro: str = "") -> None:
        for folder in msgs:
            if not folder.is_dir():
                msg = f"--msgs {folder}: no such folder; name one that holds .msg files"
                raise UsageError(msg)
        self._log = log
        self._folders = tuple(msgs)
        self._ros_distro = ros_distro
        self._decoders: dict[tuple[str, str, str], Decode] = {}

    def decode(self, message: RawMessage) -> object:
        """Return the fields of a message.

        Parameters
        ----------
        message : RawMessage
            Of encoding ``ros1``, ``cdr``, ``json`` or ``protobuf``.

        Returns
        -------
        object
            With the fields as attributes; for JSON what the text says, mostly a dict; for
            protobuf a mapping.

        Raises
        ------
        PayloadError
            If this message does not fit its definition.
        LogError
            If its type has no definition, or its encoding is not read.
        """
        topic = message.topic
        key = (topic.msgtype, topic.encoding, topic.definition)
        if key not in self._decoders:
            self._decoders[key] = self._make_decoder(topic)
        try:
            return self._decoders[key](message.payload)
        except (ValueError, LookupError, AssertionError, RecursionError) as err:
            msg = (
                f"{self._log}: a message of {topic.name} ({len(message.payload)} bytes) "
                f"does not fit its type {topic.msgtype}"
            )
            raise PayloadError(msg) from err

    def undefined_types(self, topics: Iterable[Topic]) -> tuple[str, ...]:
        """Return the types of ROS messages that are nowhere defined, sorted.

        Whether a definition can be understood is seen when it is needed.
        """
        bare = {
            (topic.msgtype, topic.encoding)
            for topic in topics
            if topic.n_messages and topic.encoding in _ROS_ENCODINGS and not topic.definition
        }
        defined = {type_of(path) for path in self._files() if path.suffix == ".msg"}
        named = {path.stem for path in self._files() if path.suffix == ".idl"}
        missing = {
            msgtype
            for msgtype, encoding in bare
            if msgtype not in defined
            and msgtype.rpartition("/")[2] not in named
            and not built_in(msgtype)
            and msgtype not in standard_types(encoding, self._ros_distro)
        }
        return tuple(sorted(missing))

    def _make_decoder(self, topic: Topic) -> Decode:
        """Return the function that decodes payloads of a topic."""
        if topic.encoding == "json":
            return json.loads
        if topic.encoding == PROTOBUF:
            return self._protobuf_decoder(topic)
        if topic.encoding not in _ROS_ENCODINGS:
            msg = (
                f"{self._log}: topic {topic.name} is encoded as {topic.encoding or '(nothing)'}; "
                f"only ros1, cdr, json and protobuf are read"
            )
            raise LogError(msg)
        return _ros_decoder(self._make_store(topic), topic)

    def _protobuf_decoder(self, topic: Topic) -> Decode:
        """Return the function that decodes payloads of a topic in protobuf."""
        if not protobuf_is_read():
            msg = f"{self._log}: topic {topic.name} is encoded as protobuf; {PROTOBUF_EXTRA}"
            raise LogError(msg)
        if not has_schema(topic.definition, topic.msgtype):
            msg = f"{self._log}: topic {topic.name} ({topic.msgtype}): {NO_SCHEMA}"
            raise LogError(msg)
        return lambda payload: read_protobuf(payload, topic.definition, topic.msgtype)

    def _make_store(self, topic: Topic) -> "Typestore":
        """Return a store that holds a type and the types of its fields."""
        # logs of one robot share definitions, and a store takes milliseconds to compile
        key = (topic.msgtype, topic.encoding, topic.definition, self._ros_distro, self._folders)
        if key not in _STORES:
            if len(_STORES) >= _MOST_STORES:
                _STORES.clear()
            _STORES[key] = self._compile_store(topic)
        return _STORES[key]

    def _compile_store(self, topic: Topic) -> "Typestore":
        """Compile a store for one type."""
        from rosbags.typesys import Stores, TypesysError, get_typestore  # noqa: PLC0415

        own = parse(topic.definition, topic.definition_format, topic.msgtype)
        try:
            found = self._collect(topic, own or {})
        except LogError as err:
            # rosserial writes "Definition of pkg/Type", which reads like a field of a lost type.
            try:
                found = self._collect(topic, {})
            except LogError:
                raise err from None
        store = get_typestore(Stores.EMPTY)
        try:
            store.register({k: v for k, v in found.items() if k not in store.fielddefs})
            store.get_msgdef(topic.msgtype)
        except (TypesysError, *BAD_DEFINITION) as err:
            msg = f"{self._log}: the definition of {topic.msgtype} cannot be used"
            raise LogError(msg) from err
        return store

    def _collect(self, topic: Topic, own: "Typesdict") -> "Typesdict":
        """Take a type and the types of its fields, each from the first place that has it."""
        standard = standard_types(topic.encoding, self._ros_distro)
        found: Typesdict = {}
        wanted = [topic.msgtype]
        while wanted:
            msgtype = wanted.pop()
            sources = (own, self._from_folders(msgtype), built_in(msgtype), standard)
            source = next((types for types in sources if msgtype in types), None)
            if source is None:
                raise LogError(self._no_definition(topic, msgtype))
            found[msgtype] = source[msgtype]
            names = {name for _, desc in source[msgtype][1] for name in type_names(desc)}
            wanted.extend(names - found.keys() - set(wanted))
        return found

    def _no_definition(self, topic: Topic, msgtype: str) -> str:
        needs = "" if msgtype == topic.msgtype else f" needs {msgtype}, which"
        return (
            f"{self._log}: type {topic.msgtype} of topic {topic.name}{needs} has no definition, "
            f"neither in the log nor in mpap; name the folder of its .msg file with --msgs DIR"
        )

    def _from_folders(self, msgtype: str) -> "Typesdict":
        """Return the type from the folders of the user; empty if it is not there."""
        for path in self._files():
            if path.suffix == ".msg" and type_of(path) != msgtype:
                continue
            if path.suffix == ".idl" and path.stem != msgtype.rpartition("/")[2]:
                continue
            form = "ros2idl" if path.suffix == ".idl" else "ros2msg"
            types = parse(path.read_text(encoding="utf-8", errors="replace"), form, msgtype)
            if types is None:
                msg = f"{path}: cannot be understood as the definition of {msgtype}"
                raise LogError(msg)
            if msgtype in types:
                return types
        return {}

    def _files(self) -> Iterator[Path]:
        """Yield the definition files of the user's folders, in a fixed order."""
        for folder in self._folders:
            for suffix in ("*.msg", "*.idl"):
                yield from sorted(folder.rglob(suffix))


def _ros_decoder(store: "Typestore", topic: Topic) -> Decode:
    """Return the function that decodes payloads of a type in a store."""
    from rosbags.serde import SerdeError  # noqa: PLC0415  # only decoding needs rosbags

    read = store.deserialize_ros1 if topic.encoding == "ros1" else store.deserialize_cdr

    def decode(payload: bytes) -> object:
        try:
            return read(payload, topic.msgtype)
        except SerdeError as err:
            raise ValueError(*err.args) from err

    return decode
