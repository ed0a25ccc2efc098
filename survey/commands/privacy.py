"""`survey privacy`: the record of processing as a page, and what is missing in it."""

from __future__ import annotations

import argparse
import sys
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

from survey.commands.options import add_content, add_store, declare, existing_store
from survey.questionnaire import LANGUAGES

__all__ = ["add"]

_MORE = """\
What is kept, for what, on which footing and how long, who receives it, how it is erased and how it is protected, made
from the questionnaires, the store and controller.toml in the content folder:

  [controller]                                       # who decides about the survey
  name = { zh = "…", en = "…" }
  address = { zh = "…", en = "…" }
  email = "…"
  [officer]                                          # of data protection, where there is one: name, address, email
  [authority]                                        # to which a visitor may complain: name, address, email
  [others]
  recipients = { zh = "…", en = "…" }                # such as whoever hosts the service, or that there are none
  transfers = { zh = "…", en = "…" }                 # to other countries, or that there are none

The running service shows the same at /privacy, with its rate limit and proxies. Exit status 1 where a key that the law
asks for is missing; the page is made all the same and says so."""


def add(commands) -> argparse.ArgumentParser:
    """Declare the command."""
    command = declare(commands, "privacy", _run, "write the record of processing (GDPR Art. 30)", _MORE)
    text = "language of the page: zh or en (default: zh)"
    command.add_argument("--language", choices=LANGUAGES, default="zh", metavar="LANGUAGE", help=text)
    command.add_argument("--out", type=Path, metavar="FILE.html", help="where to (default: standard output)")
    add_content(command)
    add_store(command)
    return command


def _run(args: argparse.Namespace) -> int:
    from survey.errors import SurveyError
    from survey.questionnaire import QuestionnaireFolder, content_folder
    from survey.web.privacy import Running, privacy_page, record_of

    content = content_folder(args.content)
    with closing(existing_store(args)) as store:
        asked = tuple(QuestionnaireFolder(content).values())
        record = record_of(content, store, asked, Running(), datetime.now(UTC).date())
    page = privacy_page(record, args.language, alone=True)
    for problem in record.statement.problems:
        print(f"survey: {problem}", file=sys.stderr)
    if args.out is None:
        print(page, end="")
    else:
        try:
            args.out.write_text(page, "utf-8")
        except OSError as error:
            raise SurveyError(
                f"{args.out}: cannot be written ({error.strerror}) – give another --out"
            ) from None
    return 1 if record.statement.problems else 0
