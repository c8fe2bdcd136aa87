"""Which sensors all logs share, where a command needs the same of each."""

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import open_readable
from mpap_cli.errors import LogError
from mpap_cli.logs.topics import choose_roles


def common_sensors(selection: LogSelection) -> frozenset[str]:
    """Return which of scan and image every log has.

    Parameters
    ----------
    selection : LogSelection
        Logs and topics; what cannot be read is left to who reads it.
    """
    shared = frozenset({"scan", "image"})
    for path in set(selection.paths()):
        try:
            reader = open_readable(path, selection)
        except LogError:
            continue
        with reader:
            roles = choose_roles(reader, selection.topic_choice)
        there = {"scan": roles.scan, "image": roles.image}
        shared &= {sensor for sensor, topic in there.items() if topic is not None}
    return shared
