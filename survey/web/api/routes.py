"""The routes: read a questionnaire, submit an answer, take it back, see results; rows only with a token."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from survey.questionnaire import Offers, Questionnaire
from survey.store import Store
from survey.web.api.jobs import Jobs
from survey.web.api.lookup import Questionnaires, find_questionnaire
from survey.web.api.rate_limit import Limit
from survey.web.api.replies import ExplainingRoute, Refusal
from survey.web.api.research import add_research
from survey.web.api.results import public_results
from survey.web.api.schema import submission_schema
from survey.web.api.submission import add_submitting

__all__ = ["described", "router"]

BASE = "/api/v1"
_REFUSALS: dict[int | str, dict[str, Any]] = {"4XX": {"model": Refusal}, 503: {"model": Refusal}}
_PUBLIC = """\
`n` and the means are those of the last step; a step comes once ten answers have come that none counted, and what is
withdrawn goes with the next one. An item's mean has its own `n`: it moves on over ten new scores at least, is rounded
to the `decimals` that they support, and is null where it would tell what a single visitor answered (`withheld`, in both
languages). Before the first step `items` and `modules` are null."""


def router(
    store: Store,
    questionnaires: Questionnaires,
    limit: Limit | None = None,
    offers: Offers = None,
    jobs: Jobs | None = None,
) -> APIRouter:
    """All routes below /api/v1, to be included in any FastAPI app, with a prefix or without.

    questionnaires: looked up anew at each request, so a mapping that reloads its files is served as it is then.
    limit: of new answers per address, the usual one when None. offers: what the place has, None: ask everything.
    jobs: where exports and analyses are made; whoever gives some ends them with close().
    """
    routes = APIRouter(prefix=BASE, route_class=ExplainingRoute, tags=["survey"], responses=_REFUSALS)
    # Routes are tried in their order, and most requests submit.
    add_submitting(routes, store, questionnaires, limit or Limit(), offers)
    _add_reading(routes, store, questionnaires, offers)
    add_research(routes, store, questionnaires, jobs or Jobs(store.where))
    return routes


def described(questionnaire: Questionnaire) -> dict[str, Any]:
    """A questionnaire as the API and the form page hand it out: items spelled out, nothing left to expand."""
    head = questionnaire.model_dump(
        mode="json", include={"id", "version", "title", "intro", "consent", "retain_until", "scale"}
    )
    modules = [
        module.model_dump(mode="json", include={"id", "title", "intro", "suggestion"})
        | {
            "items": [
                item.model_dump(mode="json", exclude={"needs"}) for item in questionnaire.items_of(module)
            ]
        }
        for module in questionnaire.modules
    ]
    return head | {"points": questionnaire.points, "modules": modules}


def _add_reading(routes: APIRouter, store: Store, questionnaires: Questionnaires, offers: Offers) -> None:
    @routes.get("/healthz", summary="Is the store there?")
    def healthz() -> dict[str, str]:
        return {"status": "ok"} | ({"erasure": "owed"} if store.erasure_owed() else {})

    @routes.get("/questionnaires", summary="All questionnaires")
    def listed() -> list[dict[str, Any]]:
        wanted = {"id", "version", "title"}
        return [found.model_dump(mode="json", include=wanted) for found in list(questionnaires.values())]

    @routes.get("/questionnaires/{key}", summary="One questionnaire with its items")
    def one(key: str) -> dict[str, Any]:
        return described(find_questionnaire(questionnaires, key).asking(offers))

    @routes.get("/questionnaires/{key}/submission.schema.json", summary="What a submission must look like")
    def schema(key: str) -> dict[str, Any]:
        return submission_schema(find_questionnaire(questionnaires, key).asking(offers))

    @routes.get(
        "/questionnaires/{key}/results",
        summary="Public means, from ten answers on, in steps of ten at least",
        description=_PUBLIC,
    )
    def results(key: str) -> dict[str, Any]:
        questionnaire = find_questionnaire(questionnaires, key)
        return public_results(questionnaire, store.public(questionnaire))
