"""Write the pages of reference from the code; ``--check`` fails if they differ."""

import sys
from collections.abc import Iterator
from pathlib import Path

import click

from docs.columns_page import column_lines
from docs.messages_page import message_lines
from mpap_cli.cli.main import mpap
from mpap_cli.commands.settings import SettingsRequest, config

FOLDER = Path(__file__).parent


def command_pages() -> Iterator[str]:
    """Yield the help of the group and of every command."""
    group = click.Context(mpap, info_name="mpap", **mpap.context_settings)
    yield "# Commands\n\nThis page is written from `mpap --help` by `make docs`.\n"
    yield f"## mpap\n\n```text\n{mpap.get_help(group)}\n```\n"
    for name in mpap.list_commands(group):
        _, command, _ = mpap.resolve_command(group, [name])
        if command is not None:
            context = click.Context(command, info_name=name, parent=group)
            yield f"## mpap {name}\n\n```text\n{command.get_help(context)}\n```\n"


def setting_lines() -> Iterator[str]:
    """Yield one table row per setting, with both profiles."""
    paper = {row.key: row.value for row in config(SettingsRequest(profile="paper"))}
    yield "# Settings\n\nThis page is written from `mpap config` by `make docs`.\n"
    yield "Section is that of Ott & Ramos (2013); `ours` is not in the paper.\n\n"
    yield "| key | robust | paper | section | meaning |\n| --- | --- | --- | --- | --- |\n"
    for row in config(SettingsRequest(profile="robust")):
        cells = (row.key, row.value, paper[row.key], row.section, row.meaning)
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def main() -> int:
    """Write or check the pages."""
    pages = {
        "cli.md": "\n".join(command_pages()),
        "columns.md": "".join(column_lines()),
        "messages.md": "".join(message_lines()),
        "settings.md": "".join(setting_lines()),
    }
    stale = [
        name
        for name, text in pages.items()
        if not (FOLDER / name).is_file() or (FOLDER / name).read_text(encoding="utf-8") != text
    ]
    if "--check" in sys.argv:
        if stale:
            sys.stderr.write(f"docs: {', '.join(stale)} out of date; run 'make docs'\n")
        return int(bool(stale))
    for name in stale:
        (FOLDER / name).write_text(pages[name], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
