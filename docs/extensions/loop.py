"""The directive ``loop``: commands, and the moving picture that they make when pages are built.

The argument names the picture: ``{loop} jam`` shows the ``jam.gif`` that its commands write.
"""

from typing import ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs.scripts.loops import LoopError, draw_commands, shown


class Loop(SphinxDirective):
    """Runs commands, and shows their picture above them."""

    has_content = True
    required_arguments = 1
    option_spec: ClassVar = {"alt": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        """Return the picture and the commands."""
        (name,) = self.arguments
        commands = "\n".join(self.content)
        try:
            draw_commands(name, commands)
        except LoopError as error:
            raise self.error(str(error)) from error
        picture = shown(name, self.options["alt"], "../" * self.env.docname.count("/"))
        code = nodes.literal_block(commands, commands, language="sh")
        return [nodes.raw("", picture, format="html"), code]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("loop", Loop)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
