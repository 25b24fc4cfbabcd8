"""Cohorts, and results side by side."""

from collections.abc import Sequence
from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import delete, func, select

from ...clinical.comparison import Member, compare, tables
from ...errors import AccessDenied, InvalidRequest
from ...storage.models import Cohort as CohortRow
from ...storage.models import CohortMember as MemberRow
from ...storage.models import Result, Role
from .. import visibility
from ..caller import Call
from ..dependencies import Asker, ExpectedVersion, allowed, allowed_slowly, check_version, tag
from ..listing import page
from ..orders import members
from ..permissions import Permission
from ..problems import Absent
from ..repetition import RepetitionKey, once
from ..results import read_document
from ..routing import api_router
from ..schemas.forms import Page, Paging
from ..schemas.work import (
    Cohort,
    CohortChange,
    CohortMember,
    CohortWithMembers,
    ComparedResult,
    Comparison,
    ComparisonOrder,
    ComparisonTable,
    NewCohort,
)

router = api_router(tag="cohorts")
Reader = Annotated[Call, allowed(Permission.COHORTS_READ)]
Writer = Annotated[Call, allowed(Permission.COHORTS_WRITE)]
Comparer = Annotated[Asker, allowed_slowly(Permission.RESULTS_READ)]


def _cohort(call: Call, cohort_id: UUID, change: bool = False) -> CohortRow:
    """A cohort; its maker and administrators may change it. Members stay hidden from those who may not see them."""
    found = call.db.get(CohortRow, cohort_id)
    if found is None:
        raise Absent("cohort", cohort_id)
    if change and call.caller.role is not Role.ADMIN and found.created_by != call.caller.user_id:
        raise AccessDenied("only its maker and administrators change a cohort: make one of your own")
    return found


def _answer(row: CohortRow, n_members: int) -> Cohort:
    return Cohort(
        id=row.id,
        created_at=row.created_at,
        version=row.version,
        name=row.name,
        description=row.description,
        n_members=n_members,
        created_by=row.created_by,
    )


def _with_members(call: Call, row: CohortRow) -> CohortWithMembers:
    query = select(MemberRow).join(Result, Result.id == MemberRow.result_id).where(MemberRow.cohort_id == row.id)
    count = call.db.scalar(select(func.count()).select_from(query.subquery())) or 0
    visible = visibility.visible_job(call.caller.sees_all, Result.job_id)
    seen = call.find(query.where(visible).order_by(MemberRow.result_id)).scalars()
    found = [CohortMember.model_validate(each) for each in seen]
    return CohortWithMembers(**_answer(row, count).model_dump(), members=found)


@router.get("/cohorts")
def list_cohorts(call: Reader, which: Annotated[Paging, Query()]) -> Page[Cohort]:
    """All cohorts, by name."""
    count = select(func.count()).where(MemberRow.cohort_id == CohortRow.id).correlate(CohortRow).scalar_subquery()
    query = select(CohortRow, count).order_by(CohortRow.name)
    return page(call, query, which, lambda row: _answer(row[0], row[1]))


@router.post("/cohorts", status_code=HTTPStatus.CREATED)
def create_cohort(call: Writer, body: NewCohort, response: Response, key: RepetitionKey = None) -> CohortWithMembers:
    """A new cohort."""

    def make() -> CohortWithMembers:
        row = CohortRow(name=body.name, description=body.description, created_by=call.caller.user_id)
        call.db.add(row)
        call.db.flush()
        _replace(call, row, body.members)
        call.audit("create", "cohorts", row.id)
        return _with_members(call, row)

    made = once(call, key, ("createCohort", body), CohortWithMembers, make)
    tag(response, made.version)
    return made


def _replace(call: Call, row: CohortRow, wanted: Sequence[ComparedResult]) -> None:
    call.db.execute(delete(MemberRow).where(MemberRow.cohort_id == row.id))
    for each in {one.result_id: one for one in wanted}.values():
        visibility.result(call, each.result_id, "read")
        call.db.add(MemberRow(cohort_id=row.id, result_id=each.result_id, group=each.group))
    call.db.flush()


@router.get("/cohorts/{cohort_id}")
def get_cohort(call: Reader, cohort_id: UUID, response: Response) -> CohortWithMembers:
    """One cohort, with those of its results that the caller may see."""
    row = _cohort(call, cohort_id)
    tag(response, row.version)
    call.audit("read", "cohorts", cohort_id)
    return _with_members(call, row)


@router.patch("/cohorts/{cohort_id}")
def change_cohort(
    call: Writer, cohort_id: UUID, body: CohortChange, response: Response, expected: ExpectedVersion
) -> CohortWithMembers:
    """Change what is given; members are replaced as a whole."""
    row = _cohort(call, cohort_id, change=True)
    check_version(row, expected)
    row.name = row.name if body.name is None else body.name
    row.description = row.description if body.description is None else body.description
    if body.members is not None:
        _replace(call, row, body.members)
    call.db.flush()
    call.audit("update", "cohorts", cohort_id)
    tag(response, row.version)
    return _with_members(call, row)


@router.delete("/cohorts/{cohort_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_cohort(call: Writer, cohort_id: UUID, expected: ExpectedVersion) -> None:
    """Delete a cohort; its results stay."""
    row = _cohort(call, cohort_id, change=True)
    check_version(row, expected)
    call.db.execute(delete(MemberRow).where(MemberRow.cohort_id == cohort_id))
    call.db.delete(row)
    call.audit("delete", "cohorts", cohort_id)


@router.post("/comparisons")
def compare_results(asker: Comparer, body: ComparisonOrder) -> Comparison:
    """Tables of several results at once; the job `compare` writes them as files, with figures."""
    with asker.begin() as call:
        inputs, _ = members(call, body.members, "read")
    read: list[Member] = []
    for each in inputs:
        document = read_document(asker.services, each.sha256)
        read.append(Member(label=each.extra["label"], group=each.extra["group"], document=document))
    labels = {member.label for member in read}
    baseline = "" if body.baseline is None else str(body.baseline)
    if baseline and baseline not in labels:
        raise InvalidRequest(f"the baseline {baseline} is not among the members")
    if len(labels) < len(read):
        raise InvalidRequest("a result is named twice among the members")
    comparison = compare(read, baseline)
    made = tables(comparison)
    chosen = {name: ComparisonTable(columns=made[name].columns, rows=made[name].rows) for name in body.tables}
    return Comparison(baseline=comparison.baseline, tables=chosen, problems=[])
