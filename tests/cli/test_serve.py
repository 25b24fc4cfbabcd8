"""A whole service, from its first start with TLS to an orderly end in the middle of an analysis, and on."""

import json
import subprocess

import psutil
import pytest
from stored import new_database, url_of
from whole_service import GAITLAB, PASSWORD, PATIENT, WholeService, make_certificate

from gaitlab.storage.database import Database
from gaitlab.storage.models import Job, JobStatus

ENDS_WITHIN = 25.0
CANCELLED_WITHIN = 2.0


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    """A service with TLS, and a signed-in administrator."""
    folder = tmp_path_factory.mktemp("serve")
    options, certificate = make_certificate(folder)
    service = WholeService(folder / "data", *options, url=url_of(new_database()), trusted=certificate)
    try:
        service.start()
        service.first = service.make_first_account()
        yield service
    finally:
        if service.process.poll() is None:
            service.stop()


def test_it_speaks_tls_and_keeps_cookies_to_it(service):
    cookie = service.first.headers["set-cookie"]
    assert cookie.startswith("__Host-gaitlab_session=") and "Secure" in cookie
    assert "max-age=" in service.client.get("/health/live").headers["strict-transport-security"]
    assert service.client.base_url.scheme == "https" and service.client.base_url.host == "127.0.0.1"


def test_it_listens_on_this_machine_only(service):
    web = [each for each in psutil.Process(service.process.pid).children() if "web_process" in " ".join(each.cmdline())]
    listening = [each.laddr.ip for each in web[0].net_connections() if each.status == psutil.CONN_LISTEN]
    assert listening == ["127.0.0.1"]


@pytest.fixture(scope="module")
def interrupted(service):
    """A job whose service was ended while it computed: its id, its process, how the service ended."""
    job_id = service.order_analysis()
    process = service.compute(job_id)
    return job_id, process, service.stop()


def test_an_orderly_end_gives_the_job_back(service, interrupted):
    job_id, process, (code, seconds) = interrupted
    assert code == 0 and seconds < ENDS_WITHIN
    assert not process.is_running()
    database = Database.open(service.environment["GAITLAB_DATABASE_URL"])
    with database.sessions() as session:
        job = session.get(Job, job_id)
    database.close()
    assert (job.status, job.attempt, job.losses) == (JobStatus.QUEUED, 1, 0)


def test_the_log_follows_a_request_into_its_job_and_holds_no_secret(service, interrupted):
    lines, job_id = service.lines(), interrupted[0]
    (order,) = [each for each in lines if each.get("event") == "request" and each["request_id"] == "order-an-analysis"]
    assert (order["method"], order["path"], order["status"]) == ("POST", "/api/v1/analyses", 201)
    (start,) = [each for each in lines if each.get("event") == "job starts" and each["job_id"] == job_id]
    assert (start["request_id"], start["attempt"]) == ("order-an-analysis", 1)
    requests = [each["request_id"] for each in lines if each.get("event") == "request"]
    assert len(set(requests)) == len(requests)
    # With the lines for people, which hold the link of the first account, and it alone.
    text, jar = service.log.read_text(), service.client.cookies
    secrets = (PASSWORD, PATIENT, *jar.values(), service.client.headers["X-CSRF-Token"], "postgresql://")
    assert not [secret for secret in secrets if secret in text]
    assert "glt_" not in json.dumps(lines) and "gll_" not in json.dumps(lines)


def test_the_next_start_goes_on_and_cancelling_kills_the_process_within_two_seconds(service, interrupted):
    job_id = interrupted[0]
    cookies, headers = service.client.cookies, service.client.headers
    service.start()
    service.client.cookies, service.client.headers["X-CSRF-Token"] = cookies, headers["X-CSRF-Token"]
    process = service.compute(job_id)
    assert service.job(job_id)["attempt"] == 2
    service.client.post(f"/api/v1/analyses/{job_id}/cancel").raise_for_status()
    process.wait(CANCELLED_WITHIN)
    service.wait(lambda: service.job(job_id)["status"] == "cancelled", 10.0)


def test_a_port_that_is_taken_is_one_sentence(service, tmp_path):
    taken = str(service.client.base_url.port)
    command = [str(GAITLAB), "serve", "--data-dir", str(tmp_path), "--port", taken]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert answer.returncode == 2 and "cannot be listened on" in answer.stderr
    assert len(answer.stderr.splitlines()) == 1
