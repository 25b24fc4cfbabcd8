"""Every operation of the API: who may use it, and a request that means something."""

from web_world import PASSWORD

from gaitlab.storage.models import Role

ROLES = {"a": Role.ADMIN, "c": Role.CLINICIAN, "r": Role.RESEARCHER, "v": Role.VIEWER}
"""Letters of the table below; '*' is everybody, strangers included."""
ALLOWED = {
    "*": """getSignInMethods signIn getSession checkLink acceptLink startSingleSignOn finishSingleSignOn getResultSchema
        getExaminationSchema getLiveness getReadiness getMetrics""",
    "acrv": """signOut changePassword startSecondFactor confirmSecondFactor removeSecondFactor listTokens createToken
        revokeToken getAbout listPatients getPatient listSessions listPatientSessions getSessionOfPatient listRecordings
        getRecording listSubjects getSubject getSubjectModel listAnalyses getAnalysis watchAnalysis listResults
        getResult getResultDocument exportResult openViewer getViewer closeViewer showViewer listCohorts getCohort
        compareResults""",
    "acv": """exportPatient getIdentity downloadRecording listAttachments downloadAttachment downloadResultFile
        listReports getReport downloadReportPdf downloadReportPage""",
    "acr": "createAnalysis cancelAnalysis retryAnalysis createCohort changeCohort deleteCohort",
    "ac": """createPatient changePatient deletePatient setIdentity deleteIdentity listShares sharePatient unsharePatient
        createSession changeSession deleteSession createRecording changeRecording deleteRecording stripRecording
        listUploads createUpload getUpload abandonUpload sendChunk finishUpload deleteAttachment createSubject
        changeSubject deleteSubject deleteResult createReport deleteReport signReport listColleagues""",
    "a": """listUsers createUser getUser changeUser deleteUser createPasswordLink listAuditLines getSystemState
        setPriority listRetentionRules setRetentionRule""",
}
MAY = {operation: letters for letters, operations in ALLOWED.items() for operation in operations.split()}


def operations_of(document):
    """Method, path template, and description of each operation."""
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield method.upper(), path, operation


def address(method, path, case, number):
    """The path with identifiers of the case; unknown parameters get something harmless."""
    ids = {
        "offset": 0,
        "name": "result.json",
        "kind": "json",
        "viewer_id": "none",
        "path": "",
        "subject": "web_sessions",
        **case.ids,
    }
    if path.endswith("/retry"):
        ids["analysis_id"] = case.failed_id
    if path.endswith(("/cancel", "/priority")):
        ids["analysis_id"] = case.waiting_id
    found = path.format_map(ids)
    return f"{found}?name=n{number}.c3d" if path.endswith("/recordings") and method == "POST" else found


def body_of(operation_id, case, number):
    """A request's JSON that is valid, and that can be sent for every `number` once more."""
    return {
        "signIn": {"login": "nobody", "password": "wrong"},
        "checkLink": {"token": "gll_0123456789"},
        "acceptLink": {"token": "gll_0123456789", "password": PASSWORD},
        "changePassword": {"old": "wrong", "new": PASSWORD},
        "confirmSecondFactor": {"code": "000000"},
        "removeSecondFactor": {"code": "000000"},
        "createUser": {"login": f"new{number}", "role": "viewer"},
        "changeUser": {"display_name": "Other"},
        "createToken": {"name": "t", "scopes": ["account"]},
        "createPatient": {"pseudonym": f"new-{number}"},
        "changePatient": {"diagnosis": "cerebral palsy"},
        "setIdentity": {"name": "Jane Doe", "birth_date": "2016-05-01"},
        "sharePatient": {"access": "read"},
        "createSession": {"visited_on": "2026-11-21"},
        "changeSession": {"condition": "barefoot"},
        "changeRecording": {"kind": "static"},
        "createSubject": {"parameters": {"mass": 31.0}},
        "changeSubject": {"parameters": {"mass": 32.0}},
        "createUpload": {"session_id": case.session_id, "name": "walk.c3d", "size": 10},
        "createAnalysis": {"kind": "inspect", "recording_id": case.recording_id},
        "setPriority": {"priority": 5},
        "setRetentionRule": {"days": 30},
        "createReport": {"kind": "report", "result_id": case.result_id},
        "signReport": {"password": PASSWORD},
        "createCohort": {"name": f"new {number}", "members": [{"result_id": case.result_id}]},
        "changeCohort": {"description": "changed"},
        "compareResults": {"members": [{"result_id": case.result_id}]},
    }.get(operation_id)
