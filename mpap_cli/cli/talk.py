"""What is said on stderr: one line each, whatever names from logs hold."""

import logging

from mpap_cli.outputs.text_table import printable


class _OneLine(logging.Formatter):
    """Formats a record as one line without control characters."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        return printable(super().format(record))


def talk_on_stderr(*, verbose: bool) -> None:
    """Send what the package logs to stderr; with ``verbose`` the details too."""
    handler = logging.StreamHandler()
    handler.setFormatter(_OneLine("mpap: %(message)s"))
    logger = logging.getLogger("mpap_cli")
    logger.handlers = [handler]
    logger.setLevel(logging.DEBUG if verbose else logging.INFO)


def be_quiet() -> None:
    """Say errors only; what is warned of still stands beside the results."""
    for handler in _talking():
        handler.setLevel(logging.ERROR)


def is_quiet() -> bool:
    """Tell whether only errors are said."""
    return any(handler.level >= logging.ERROR for handler in _talking())


def _talking() -> list[logging.Handler]:
    """Return the handlers that write on stderr."""
    handlers = logging.getLogger("mpap_cli").handlers
    return [handler for handler in handlers if isinstance(handler, logging.StreamHandler)]
