"""An upload of 500 MB, watched from outside: what it costs the web process."""

from pathlib import Path

from gaitlab.storage.models import Role

BIG, CHUNK = 500_000_000, 8 << 20
WAYS = ("chunks", "one request")


def memory_of_upload(world, process, way):
    """Memory that the web process needs beyond what it had before [bytes], at the highest."""
    clinician = world.as_role(Role.CLINICIAN)
    # Linux then counts the highest anew.
    Path(f"/proc/{process.pid}/clear_refs").write_text("5")
    before = highest_memory(process)
    pieces = (number.to_bytes(4, "big") * 250_000 for number in range(BIG // 1_000_000))
    if way == "chunks":
        body = {"session_id": world.case.session_id, "name": "v.mp4", "media_type": "video/mp4", "size": BIG}
        upload = world.client.post("/api/v1/uploads", headers=clinician, json=body).json()["id"]
        send_chunks(world, clinician, upload, pieces)
        done = world.client.post(f"/api/v1/uploads/{upload}/finish", headers=clinician)
        assert done.status_code == 201
    else:
        address = f"/api/v1/sessions/{world.case.session_id}/recordings?name=big.c3d"
        answer = world.client.post(address, headers=clinician, content=pieces)
        assert answer.status_code == 422 and "not a C3D file" in answer.json()["detail"]
    return highest_memory(process) - before


def highest_memory(process):
    """Most memory that a process has had at a time [bytes]."""
    (line,) = [line for line in Path(f"/proc/{process.pid}/status").read_text().splitlines() if "VmHWM" in line]
    return 1024 * int(line.split()[1])


def send_chunks(world, clinician, upload, pieces):
    """Send the content as the pages do, in chunks of a fixed size."""
    offset, waiting = 0, b""
    for piece in pieces:
        waiting += piece
        while len(waiting) >= CHUNK or (waiting and offset + len(waiting) == BIG):
            part, waiting = waiting[:CHUNK], waiting[CHUNK:]
            address = f"/api/v1/uploads/{upload}/chunks/{offset}"
            assert world.client.put(address, headers=clinician, content=part).status_code == 200
            offset += len(part)
