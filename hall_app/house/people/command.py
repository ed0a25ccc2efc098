"""`hall admin`: the people of the house from the command line, for whoever may read the data folder."""

from __future__ import annotations

import argparse
import getpass
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hall_app.house.people import People, Person

__all__ = ["add_accounts", "add_data", "add_parser", "run"]

_DESCRIPTION = """\
Administer the accounts of a house: name its first administrator, open an account whose password was lost, see who
is staff, shut somebody out. It works on the data folder, beside a hall that is open or not, and needs no mail server.
Everything done here stands in the journal (/office/audit) as done by the console."""

_EPILOG = """\
a new house:
  hall admin create anna@example.org              asks for a password, makes the first administrator
  hall serve                                      then sign in at http://127.0.0.1:8000/office

somebody lost a password, or a visitor stands at the desk:
  hall admin code anna@example.org                a code to read out or print; typed in at /me/open
  hall admin link anna@example.org --url https://hall.example.org
                                                  a link to hand over; both are good once, for three days

somebody left, or a device was lost:
  hall admin revoke anna@example.org              end all sessions
  hall admin revoke anna@example.org --roles      and take all roles
  hall admin delete anna@example.org              asks once more, and leaves nothing of the account but its backups

There is no default password. A password never stands on the command line, where others could read it: it is asked for,
or made (--generate) and shown once. --data and --accounts must be those of `hall serve`.
Exit status: 0 done, 1 it failed (the message says why), 2 wrong arguments."""

_MADE_UP = "This password is shown once and kept nowhere:"


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare `hall admin`."""
    parser = subparsers.add_parser(
        "admin",
        help="accounts: the first administrator, lost passwords, who is staff",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    create = _action(actions, "create", "make an account with a role, or give the role to one that is there")
    create.add_argument("--name", default="", help="what to call the person")
    create.add_argument("--language", choices=("zh", "en"), default="zh", help="of the pages (default zh)")
    create.add_argument(
        "--role",
        action="append",
        choices=("editor", "curator", "researcher", "administrator"),
        help="role to give, may stand more than once (default administrator)",
    )
    create.add_argument("--generate", action="store_true", help="make a password and print it once")
    link = _action(
        actions, "link", "print a link that opens the account once: verifies it, sets a new password"
    )
    link.add_argument(
        "--url",
        default="http://127.0.0.1:8000",
        help="address of the hall as the person reaches it (default http://127.0.0.1:8000)",
    )
    _action(actions, "code", "print a code that does the same, typed in at /me/open")
    listed = _action(actions, "list", "list staff", address=False)
    listed.add_argument("--visitors", action="store_true", help="visitors' accounts as well")
    revoke = _action(actions, "revoke", "end all sessions of an account")
    revoke.add_argument("--roles", action="store_true", help="and take all its roles")
    revoke.add_argument(
        "--second-factor", action="store_true", help="and forget its authenticator, where the phone is lost"
    )
    gone = _action(
        actions, "delete", "delete an account with all that is kept of it, as its owner would at /me"
    )
    gone.add_argument("--yes", action="store_true", help="do not ask for the address again")
    parser.set_defaults(run=run)


def add_accounts(parser: argparse.ArgumentParser) -> None:
    """Declare where accounts are kept."""
    parser.add_argument(
        "--accounts",
        metavar="URL",
        help="database of accounts, postgresql+psycopg://… (default: people.sqlite in --data)",
    )


def add_data(parser: argparse.ArgumentParser, what: str = "data folder of the hall") -> None:
    """Declare where a hall keeps its data."""
    parser.add_argument(
        "--data",
        type=Path,
        default=Path("hall-data"),
        metavar="FOLDER",
        help=f"{what} (default ./hall-data)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Do it; what fails is one line on standard error."""
    from hall_app.house.people import People, existing_people

    where: Path | str = arguments.accounts or arguments.data
    people = People(where) if arguments.action == "create" else existing_people(where)
    try:
        return _DONE[arguments.action](people, arguments)
    finally:
        people.close()


def _action(actions, name: str, told: str, *, address: bool = True) -> argparse.ArgumentParser:
    parser = actions.add_parser(name, help=told, description=told[:1].upper() + told[1:] + ".")
    if address:
        parser.add_argument("address", metavar="EMAIL", help="address of the account")
    add_data(parser)
    add_accounts(parser)
    return parser


def _create(people: People, arguments: argparse.Namespace) -> int:
    from hall_app.house.people import PeopleError, Role
    from hall_app.house.people.credentials import checked_password, new_password
    from hall_app.house.people.database import CONSOLE
    from hall_app.house.people.records import checked_address

    address, made_up = checked_address(arguments.address), ""
    wanted = frozenset(Role(name) for name in arguments.role or ["administrator"])
    try:
        person = people.accounts.find(address=address)
    except PeopleError:
        person = None
    if person is not None and person.verified is not None:
        print(f"{address} has an account: it keeps its password.")
    else:
        password = made_up = new_password() if arguments.generate else ""
        if not made_up:
            password = checked_password(_asked(), address)
        if person is None:
            person = people.accounts.make(CONSOLE, address, name=arguments.name, language=arguments.language)
        else:  # whoever made it never proved that the address is his
            print(
                f"{address} had an account that was never confirmed: it gets a new password, its sessions end."
            )
            if person.second_factor:
                people.accounts.drop_second_factor(CONSOLE, person.id)
        people.accounts.use_code(people.accounts.code_for(CONSOLE, person.id), password)
    people.roles.set(CONSOLE, person.id, person.roles | wanted)
    print(f"{address}: {', '.join(sorted(person.roles | wanted))}. Sign in at /office.")
    if made_up:
        print(f"{_MADE_UP}\n  {made_up}")
    return 0


def _asked() -> str:
    """The password as typed twice, unseen. Raises ValueError."""
    if not sys.stdin.isatty():
        raise ValueError("no terminal to ask for a password at – give --generate to have one made")
    first = getpass.getpass("Password (at least 10 characters, not shown): ")
    if first != getpass.getpass("The same again: "):
        raise ValueError("the two passwords differ – nothing was changed, start again")
    return first


def _link(people: People, arguments: argparse.Namespace) -> int:
    from hall_app.house.people.database import CONSOLE

    person = people.accounts.find(address=arguments.address)
    secret = people.accounts.code_for(CONSOLE, person.id, long=True)
    print(
        f"Good once, for three days, for whoever has it:\n  {arguments.url.rstrip('/')}/me/open?code={secret}"
    )
    return 0


def _code(people: People, arguments: argparse.Namespace) -> int:
    from hall_app.house.people.database import CONSOLE

    person = people.accounts.find(address=arguments.address)
    print(
        f"Good once, for three days, typed in at /me/open:\n  {people.accounts.code_for(CONSOLE, person.id)}"
    )
    return 0


def _list(people: People, arguments: argparse.Namespace) -> int:
    listed = people.accounts.all(most=10_000)
    shown = [one for one in listed if one.roles or arguments.visitors]
    for one in shown:
        print(_line(people, one))
    if not shown:
        print("Nobody yet: `hall admin create EMAIL` makes the first administrator.")
    return 0


def _line(people: People, person: Person) -> str:
    sessions = len(people.sessions.of(person.id))
    facts = (
        ", ".join(sorted(person.roles)) or "visitor",
        "verified" if person.verified else "not verified",
        "second factor" if person.second_factor else "",
        "closed" if person.closed else "",
        f"{sessions} session{'' if sessions == 1 else 's'}",
    )
    name = f" ({person.name})" if person.name else ""
    return f"{person.address}{name}: {'; '.join(fact for fact in facts if fact)}"


def _delete(people: People, arguments: argparse.Namespace) -> int:
    from hall_app.house.people.database import CONSOLE
    from hall_app.house.people.records import checked_address

    person = people.accounts.find(address=arguments.address)
    if not arguments.yes:
        if not sys.stdin.isatty():
            raise ValueError("no terminal to confirm this at – give --yes to delete the account unasked")
        told = input(f"This cannot be undone. Type {person.address} again to delete the account: ")
        if checked_address(told) != person.address:
            raise ValueError("another address was typed – nothing was deleted, start again")
    people.accounts.remove(CONSOLE, person.id)
    print(f"{person.address}: deleted, with all that was kept of it. Backups made before still have it.")
    return 0


def _revoke(people: People, arguments: argparse.Namespace) -> int:
    from hall_app.house.people.database import CONSOLE

    person = people.accounts.find(address=arguments.address)
    if arguments.roles:
        people.roles.set(CONSOLE, person.id, frozenset())
    if arguments.second_factor:
        people.accounts.drop_second_factor(CONSOLE, person.id)
    count = people.sessions.end_all(CONSOLE, "people", person.id)
    taken = ", all roles taken" if arguments.roles else ""
    forgotten = ", authenticator forgotten" if arguments.second_factor else ""
    print(f"{person.address}: {count} session{'' if count == 1 else 's'} ended{taken}{forgotten}.")
    return 0


_DONE = {
    "create": _create,
    "link": _link,
    "code": _code,
    "list": _list,
    "revoke": _revoke,
    "delete": _delete,
}
