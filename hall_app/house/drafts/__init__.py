"""The collection edited: drafts of exhibits beside the hall, looked at, put in place, undone.

shelf: files by their digest; drafts: what is to become of an exhibit's files; intake: what is brought from outside, by
what it holds; portrait: a model drawn; shape: the same to be turned; examination: the hall's check of a draft;
publication: in place, whole or not at all, and back again.
"""

from hall_app.house.beside import beside
from hall_app.house.drafts.drafts import LONGEST_ID, TEXT_FILES, Draft, Drafts
from hall_app.house.drafts.examination import Examination
from hall_app.house.drafts.intake import LARGEST, USES, Taken, take_in
from hall_app.house.drafts.portrait import portrait
from hall_app.house.drafts.publication import Publication
from hall_app.house.drafts.shape import MOST_TURNED, shape
from hall_app.house.drafts.shelf import QUOTA, Shelf

__all__ = [
    "LARGEST",
    "MOST_TURNED",
    "LONGEST_ID",
    "QUOTA",
    "TEXT_FILES",
    "USES",
    "Draft",
    "Drafts",
    "Examination",
    "Publication",
    "Shelf",
    "Taken",
    "beside",
    "portrait",
    "shape",
    "take_in",
]
