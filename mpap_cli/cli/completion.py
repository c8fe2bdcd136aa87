"""``mpap completion``."""

import click
from click.shell_completion import get_completion_class

SHELLS = ("bash", "fish", "zsh")


@click.command(
    epilog="""\b
Example:
  mpap completion bash > ~/.local/share/bash-completion/completions/mpap
""",
)
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print the completion script of a shell."""
    kind = get_completion_class(shell)
    if kind is None:
        msg = f"this version of click has no completion for {shell}"
        raise click.ClickException(msg)
    root = context.find_root()
    click.echo(kind(root.command, {}, "mpap", "_MPAP_COMPLETE").source())
