"""Names of files that every system takes, made of names from logs."""

import re

_ODD_CHARACTERS = re.compile(r"[^\w.-]", re.ASCII)
_MOST_LETTERS = 100
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)


def file_name(name: str, ending: str = "") -> str:
    """Return a name for a file on Linux, macOS and Windows.

    Parameters
    ----------
    name : str
        What it is named after: a log, a topic.
    ending : str
        What follows, such as ``.mcap``; it stays as it is.

    Returns
    -------
    str
        ASCII letters, digits, ``_``, ``.`` and ``-``, at most 100 of them before the ending.
        Different names may become one: who needs several puts a number before them.

    Examples
    --------
    >>> file_name("/camera/front", ".png"), file_name("a:b?.bag", ".mcap")
    ('_camera_front.png', 'a_b_.bag.mcap')
    >>> file_name("NUL.bag"), file_name("run. "), file_name("..")
    ('_NUL.bag', 'run._', '_')
    """
    whole = _ODD_CHARACTERS.sub("_", name)[:_MOST_LETTERS] + ending
    if _DEVICES.match(whole):  # Windows opens the device, whatever ends the name
        whole = f"_{whole}"
    return whole.rstrip(".") or "_"
