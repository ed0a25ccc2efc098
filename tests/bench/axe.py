"""What axe-core finds wrong with a page for those who hear it read, in all its frames."""

from axe_playwright_python.base import AXE_SCRIPT

# What WCAG 2.2 AA asks for, and axe's own advice on landmarks, headings and the like.
TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]

# Frames answer to one another also where a page has no address of its own.
HEARD = "() => axe.configure({ allowedOrigins: ['<unsafe_all_origins>'] })"
RUN = "([within, options]) => axe.run(within ?? document, options)"


def violations(page, within: str | None = None) -> list[str]:
    """One line for each thing that breaks a rule: rule, what is asked, where; empty for a clean page.

    page: playwright's page, as it is now; within: a CSS selector of the one part to look at, None for the whole.
    """
    for frame in page.frames:
        frame.evaluate(AXE_SCRIPT)  # a frame is looked at where the script is in it as well
        frame.evaluate(HEARD)
    options = {"resultTypes": ["violations"], "runOnly": {"type": "tag", "values": TAGS}}
    found = page.evaluate(RUN, [within, options])["violations"]
    return [
        f"{rule['id']} ({rule['impact']}): {rule['help']} – {_where(node)}"
        for rule in found
        for node in rule["nodes"]
    ]


def _where(node: dict) -> str:
    """The node's selector, frame by frame, and its beginning."""
    parts = [step if isinstance(step, str) else " >>> ".join(step) for step in node["target"]]
    return f"{' | '.join(parts)}: {node['html'][:120]}"
