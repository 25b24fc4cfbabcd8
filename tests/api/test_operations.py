"""What whoever runs the service asks it: is it ready, how does it do, how long does it keep what."""

from sqlalchemy import select, update
from web_world import running_world

from gaitlab.storage.models import AuditEntry, Job, JobKind, JobStatus, RetentionRule, Role

SECRET = "a token for the scraper"


def numbers(text):
    """Value of every line of an answer of /metrics."""
    lines = [line.rpartition(" ") for line in text.splitlines() if not line.startswith("#")]
    return {name: float(value) for name, _, value in lines}


def test_the_metrics_count_waiting_running_and_failed_jobs_by_kind(world, case):
    before = numbers(world.client.get("/metrics").text)
    with world.services.database.transaction() as db:
        failure = {"status": JobStatus.FAILED, "failure": {"kind": "time_out"}}
        db.execute(update(Job).where(Job.id == case.waiting_id).values(**failure))
    text = world.client.get("/metrics").text
    after = numbers(text)

    def grown(name):
        return after[name] - before.get(name, 0.0)

    assert grown('gaitlab_jobs{kind="analyse",status="queued"}') == -1
    assert grown('gaitlab_jobs{kind="analyse",status="failed"}') == 1
    assert grown('gaitlab_jobs_failed{failure="time_out",kind="analyse"}') == 1
    every = {f'gaitlab_jobs{{kind="{kind}",status="{status}"}}' for kind in JobKind for status in JobStatus}
    assert every <= set(after) and {"gaitlab_workers", "gaitlab_longest_wait_seconds"} <= set(after)
    assert case.patient_id not in text


def test_requests_are_counted_by_route_and_not_by_patient(world, case):
    name = 'gaitlab_requests_total{method="GET",route="/api/v1/patients/{patient_id}",status="200"}'
    before = numbers(world.client.get("/metrics").text).get(name, 0.0)
    world.client.get(f"/api/v1/patients/{case.patient_id}", headers=world.as_role(Role.CLINICIAN))
    assert numbers(world.client.get("/metrics").text)[name] == before + 1


def test_metrics_are_for_this_machine_or_for_whoever_has_the_token(world, tmp_path):
    assert world.client.get("/metrics", headers={"X-Forwarded-For": "203.0.113.9"}).status_code == 401
    with running_world(tmp_path, metrics_token=SECRET) as closed:
        assert closed.client.get("/metrics").status_code == 401
        assert closed.client.get("/metrics", headers={"Authorization": f"Bearer {SECRET}"}).status_code == 200


def test_it_is_not_ready_without_its_files(tmp_path):
    with running_world(tmp_path) as world:
        assert world.client.get("/health/ready").json() == {"status": "ready", "database": "ready", "files": "ready"}
        (tmp_path / "files" / "spool").rename(tmp_path / "elsewhere")
        answer = world.client.get("/health/ready")
        assert (answer.status_code, answer.json()["files"]) == (503, "away")
        assert world.client.get("/health/live").status_code == 200


def test_the_request_of_a_job_is_known(world, case):
    headers = world.as_role(Role.CLINICIAN) | {"X-Request-ID": "order-of-a-job"}
    world.client.post(
        "/api/v1/analyses", headers=headers, json={"kind": "analyse", "session_id": case.session_id}
    ).raise_for_status()
    with world.services.database.sessions() as db:
        assert len(db.scalars(select(Job).where(Job.request_id == "order-of-a-job")).all()) == 1


def test_an_administrator_sets_how_long_things_are_kept(world):
    admin, address = world.people[Role.ADMIN], "/api/v1/retention"
    try:
        made = world.client.put(f"{address}/login_attempts", headers=admin.headers, json={"days": 7})
        assert made.json() == {"subject": "login_attempts", "days": 7}
        kept = {each["subject"]: each["days"] for each in world.client.get(address, headers=admin.headers).json()}
        assert (kept["login_attempts"], kept["patients"]) == (7, None)
        unknown = world.client.put(f"{address}/everything", headers=admin.headers, json={"days": 7})
        assert unknown.status_code == 404 and "login_attempts" in unknown.json()["detail"]
        with world.services.database.sessions() as db:
            assert db.get(RetentionRule, "login_attempts").days == 7
            lines = select(AuditEntry).where(AuditEntry.kind == "retention_rules").order_by(AuditEntry.id.desc())
            line = db.scalars(lines).first()
        assert (line.user_id, line.object_id, line.detail["days"]) == (admin.id, "login_attempts", 7)
    finally:
        back = world.client.put(f"{address}/login_attempts", headers=admin.headers, json={"days": None})
    assert back.json()["days"] == 30
