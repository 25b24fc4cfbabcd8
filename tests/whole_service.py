"""`gaitlab serve` as a process of its own, as an operator starts it, and an administrator with the first account."""

import json
import os
import re
import signal
import ssl
import subprocess
import sys
import time
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path

import httpx
import psutil
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

GAITLAB = Path(sys.executable).parent / "gaitlab"
PASSWORD = "a long enough password"
STARTS_WITHIN = 120.0
COMPUTING = "gaitlab.jobs.computing_process"
DEMO = Path(__file__).parents[1] / "data" / "demo_able_bodied_child"
PATIENT = "Jane Doe"


def make_certificate(folder):
    """Options for TLS with a certificate of its own for this machine, and the file that a client trusts."""
    key, today = ec.generate_private_key(ec.SECP256R1()), datetime.now(UTC)
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "gaitlab test")])
    alternative = x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))])
    made = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
    made = made.not_valid_before(today - timedelta(days=1)).not_valid_after(today + timedelta(days=1))
    made = made.add_extension(alternative, critical=False).add_extension(x509.BasicConstraints(True, None), True)
    certificate, secret = folder / "certificate.pem", folder / "key.pem"
    certificate.write_bytes(made.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    plain = serialization.NoEncryption()
    secret.write_bytes(key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, plain))
    return ["--tls-certificate", str(certificate), "--tls-key", str(secret)], certificate


class WholeService:
    """The service on a data folder; `url` names another database than the embedded one."""

    def __init__(self, data, *options, url=None, trusted=None):
        self.data, self.options, self.trusted = data, options, trusted
        self.environment = os.environ | ({"GAITLAB_DATABASE_URL": url} if url else {})
        self.log = data.parent / f"{data.name}.log"
        self.process, self.client = None, None

    def start(self):
        """Start it, wait until it is ready, and open a client."""
        command = [str(GAITLAB), "serve", "--data-dir", str(self.data), "--port", "0", *self.options]
        before = self.log.stat().st_size if self.log.exists() else 0
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(command, env=self.environment, stderr=log)
        address = self.wait(lambda: re.search(r"^gaitlab: (http\S+)$", self.log.read_text()[before:], re.MULTILINE))
        trust = ssl.create_default_context(cafile=self.trusted)
        self.client = httpx.Client(base_url=address[1], timeout=60.0, verify=trust)
        self.wait(lambda: self.client.get("/health/ready").status_code == 200)

    def wait(self, look, seconds=STARTS_WITHIN):
        """What `look` finds once it finds something."""
        deadline = time.monotonic() + seconds
        while not (found := look()):
            assert self.process.poll() is None and time.monotonic() < deadline, self.log.read_text()[-3000:]
            time.sleep(0.05)
        return found

    def make_first_account(self):
        """Follow the link that was printed; the client is signed in afterwards."""
        token = re.search(r"/link#(\S+)", self.log.read_text())[1]
        body = {"token": token, "login": "admin", "password": PASSWORD}
        made = self.client.post("/api/v1/auth/link/accept", json=body)
        assert made.status_code == 201, made.text
        self.client.headers["X-CSRF-Token"] = made.json()["csrf_token"]
        return made

    def make_visit(self):
        """A patient with a name, a visit, and its recordings; the visit's id."""
        patient = self.post("patients", {"pseudonym": f"P-{time.monotonic_ns()}"})["id"]
        self.client.put(f"/api/v1/patients/{patient}/identity", json={"name": PATIENT}).raise_for_status()
        visit = self.post(f"patients/{patient}/sessions", {"visited_on": "2026-11-20"})["id"]
        for name in ("static.c3d", "walk1.c3d"):
            content = (DEMO / name).read_bytes()
            address = f"/api/v1/sessions/{visit}/recordings?name={name}"
            self.client.post(address, content=content).raise_for_status()
        return visit

    def order_analysis(self, request_id="order-an-analysis"):
        """Ask for a whole analysis of a new patient's visit; the job's id."""
        order = {"kind": "analyse", "session_id": self.make_visit()}
        return self.post("analyses", order, {"X-Request-ID": request_id})["id"]

    def post(self, path, body, headers=None):
        answer = self.client.post(f"/api/v1/{path}", json=body, headers=headers)
        assert answer.status_code == 201, answer.text
        return answer.json()

    def job(self, job_id):
        return self.client.get(f"/api/v1/analyses/{job_id}").json()

    def computing(self):
        """The processes that compute now."""
        family = psutil.Process(self.process.pid).children(recursive=True)
        return [each for each in family if _computes(each)]

    def compute(self, job_id):
        """Wait until the job is in the middle of its computation; its process."""
        self.wait(lambda: self.job(job_id)["progress"])
        return self.wait(self.computing)[0]

    def stop(self):
        """End it in order; its exit code, and the seconds that it took."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(60)
        if self.client is not None:
            self.client.close()
        return code, time.monotonic() - begin

    def lines(self):
        """The log: every line but the few for people is JSON."""
        return [json.loads(line) for line in self.log.read_text().splitlines() if not line.startswith("gaitlab: ")]


def _computes(process):
    try:
        # The whole analysis; the look into an upload is over in a moment.
        return COMPUTING in process.cmdline() and process.nice() > 0
    except psutil.Error:
        return False
