-- Tables of gaitlab, form 0001. PostgreSQL 15 to 18. Nothing is ever deleted by cascade.

CREATE TABLE audit_log (
    id BIGSERIAL NOT NULL,
    action VARCHAR NOT NULL,
    kind VARCHAR NOT NULL,
    at TIMESTAMP WITH TIME ZONE NOT NULL,
    user_id UUID,
    login VARCHAR NOT NULL,
    object_id VARCHAR NOT NULL,
    patient_id UUID,
    request_id VARCHAR NOT NULL,
    address VARCHAR NOT NULL,
    detail JSONB NOT NULL,
    CONSTRAINT pk_audit_log PRIMARY KEY (id)
);

CREATE INDEX ix_audit_log_at ON audit_log (at);
CREATE INDEX ix_audit_log_patient_id_at ON audit_log (patient_id, at);
CREATE INDEX ix_audit_log_user_id ON audit_log (user_id);

CREATE TABLE login_attempts (
    id SERIAL NOT NULL,
    login_hash CHAR(64) NOT NULL,
    address VARCHAR NOT NULL,
    succeeded BOOLEAN NOT NULL,
    at TIMESTAMP WITH TIME ZONE NOT NULL,
    CONSTRAINT pk_login_attempts PRIMARY KEY (id)
);

CREATE INDEX ix_login_attempts_address_at ON login_attempts (address, at);
CREATE INDEX ix_login_attempts_at ON login_attempts (at);
CREATE INDEX ix_login_attempts_login_at ON login_attempts (login_hash, at);

CREATE TABLE retention_rules (
    subject VARCHAR NOT NULL,
    days INTEGER NOT NULL,
    CONSTRAINT pk_retention_rules PRIMARY KEY (subject)
);

CREATE TABLE stored_files (
    sha256 CHAR(64) NOT NULL,
    size BIGINT NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_stored_files PRIMARY KEY (sha256)
);

CREATE TABLE users (
    login VARCHAR NOT NULL,
    role VARCHAR(24) NOT NULL,
    display_name VARCHAR NOT NULL,
    password_hash VARCHAR,
    totp_secret VARCHAR,
    totp_confirmed BOOLEAN NOT NULL,
    totp_last_step INTEGER,
    oidc_subject VARCHAR,
    active BOOLEAN NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_users PRIMARY KEY (id),
    CONSTRAINT uq_users_login UNIQUE (login),
    CONSTRAINT ck_users_role CHECK (role IN ('admin', 'clinician', 'researcher', 'viewer')),
    CONSTRAINT uq_users_oidc_subject UNIQUE (oidc_subject)
);

CREATE INDEX ix_users_created_at ON users (created_at);

CREATE TABLE api_tokens (
    user_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    token_hash CHAR(64) NOT NULL,
    scopes VARCHAR[] NOT NULL,
    expires_at TIMESTAMP WITH TIME ZONE,
    last_used_at TIMESTAMP WITH TIME ZONE,
    revoked_at TIMESTAMP WITH TIME ZONE,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_api_tokens PRIMARY KEY (id),
    CONSTRAINT fk_api_tokens_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT uq_api_tokens_token_hash UNIQUE (token_hash)
);

CREATE INDEX ix_api_tokens_created_at ON api_tokens (created_at);
CREATE INDEX ix_api_tokens_user_id ON api_tokens (user_id);

CREATE TABLE cohorts (
    name VARCHAR NOT NULL,
    description VARCHAR NOT NULL,
    created_by UUID,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_cohorts PRIMARY KEY (id),
    CONSTRAINT uq_cohorts_name UNIQUE (name),
    CONSTRAINT fk_cohorts_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_cohorts_created_at ON cohorts (created_at);

CREATE TABLE idempotency_keys (
    user_id UUID NOT NULL,
    key VARCHAR NOT NULL,
    request_hash CHAR(64) NOT NULL,
    status INTEGER,
    headers JSONB NOT NULL,
    body BYTEA NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_idempotency_keys PRIMARY KEY (id),
    CONSTRAINT fk_idempotency_keys_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_idempotency_keys_created_at ON idempotency_keys (created_at);
CREATE UNIQUE INDEX uq_idempotency_keys_user_id_key ON idempotency_keys (user_id, key);

CREATE TABLE one_time_tokens (
    purpose VARCHAR(24) NOT NULL,
    token_hash CHAR(64) NOT NULL,
    expires_at TIMESTAMP WITH TIME ZONE NOT NULL,
    user_id UUID,
    role VARCHAR(24),
    used_at TIMESTAMP WITH TIME ZONE,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_one_time_tokens PRIMARY KEY (id),
    CONSTRAINT ck_one_time_tokens_one_time_purpose CHECK (purpose IN ('first_account', 'invitation', 'password_reset')),
    CONSTRAINT uq_one_time_tokens_token_hash UNIQUE (token_hash),
    CONSTRAINT fk_one_time_tokens_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT ck_one_time_tokens_role CHECK (role IN ('admin', 'clinician', 'researcher', 'viewer'))
);

CREATE INDEX ix_one_time_tokens_created_at ON one_time_tokens (created_at);

CREATE TABLE patients (
    pseudonym VARCHAR NOT NULL,
    sex VARCHAR NOT NULL,
    diagnosis VARCHAR NOT NULL,
    notes VARCHAR NOT NULL,
    created_by UUID,
    retain_until DATE,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_patients PRIMARY KEY (id),
    CONSTRAINT uq_patients_pseudonym UNIQUE (pseudonym),
    CONSTRAINT fk_patients_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_patients_created_at ON patients (created_at);
CREATE INDEX ix_patients_retain_until ON patients (retain_until);

CREATE TABLE web_sessions (
    user_id UUID NOT NULL,
    token_hash CHAR(64) NOT NULL,
    csrf_hash CHAR(64) NOT NULL,
    expires_at TIMESTAMP WITH TIME ZONE NOT NULL,
    last_seen_at TIMESTAMP WITH TIME ZONE NOT NULL,
    second_factor BOOLEAN NOT NULL,
    revoked_at TIMESTAMP WITH TIME ZONE,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_web_sessions PRIMARY KEY (id),
    CONSTRAINT fk_web_sessions_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT uq_web_sessions_token_hash UNIQUE (token_hash)
);

CREATE INDEX ix_web_sessions_created_at ON web_sessions (created_at);
CREATE INDEX ix_web_sessions_expires_at ON web_sessions (expires_at);
CREATE INDEX ix_web_sessions_user_id ON web_sessions (user_id);

CREATE TABLE patient_identities (
    patient_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    birth_date DATE,
    record_number VARCHAR NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_patient_identities PRIMARY KEY (patient_id),
    CONSTRAINT fk_patient_identities_patient_id_patients FOREIGN KEY(patient_id) REFERENCES patients (id) ON DELETE RESTRICT
);

CREATE TABLE patient_shares (
    patient_id UUID NOT NULL,
    user_id UUID NOT NULL,
    access VARCHAR(24) NOT NULL,
    created_by UUID,
    created_at TIMESTAMP WITH TIME ZONE NOT NULL,
    CONSTRAINT pk_patient_shares PRIMARY KEY (patient_id, user_id),
    CONSTRAINT fk_patient_shares_patient_id_patients FOREIGN KEY(patient_id) REFERENCES patients (id) ON DELETE RESTRICT,
    CONSTRAINT fk_patient_shares_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT ck_patient_shares_access CHECK (access IN ('read', 'write')),
    CONSTRAINT fk_patient_shares_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_patient_shares_user_id ON patient_shares (user_id);

CREATE TABLE sessions (
    patient_id UUID NOT NULL,
    visited_on DATE NOT NULL,
    label VARCHAR NOT NULL,
    condition VARCHAR NOT NULL,
    treatment VARCHAR NOT NULL,
    stage VARCHAR(24) NOT NULL,
    age_years DOUBLE PRECISION,
    examination JSONB NOT NULL,
    notes VARCHAR NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_sessions PRIMARY KEY (id),
    CONSTRAINT fk_sessions_patient_id_patients FOREIGN KEY(patient_id) REFERENCES patients (id) ON DELETE RESTRICT,
    CONSTRAINT ck_sessions_treatment_stage CHECK (stage IN ('before', 'after', 'none'))
);

CREATE INDEX ix_sessions_created_at ON sessions (created_at);
CREATE INDEX ix_sessions_patient_id ON sessions (patient_id);

CREATE TABLE attachments (
    session_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    media_type VARCHAR NOT NULL,
    sha256 CHAR(64) NOT NULL,
    size BIGINT NOT NULL,
    created_by UUID,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_attachments PRIMARY KEY (id),
    CONSTRAINT fk_attachments_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_attachments_sha256_stored_files FOREIGN KEY(sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT,
    CONSTRAINT fk_attachments_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_attachments_created_at ON attachments (created_at);
CREATE INDEX ix_attachments_session_id ON attachments (session_id);
CREATE INDEX ix_attachments_sha256 ON attachments (sha256);

CREATE TABLE jobs (
    kind VARCHAR(24) NOT NULL,
    input_hash CHAR(64) NOT NULL,
    session_id UUID,
    created_by UUID,
    inputs JSONB NOT NULL,
    settings JSONB NOT NULL,
    status VARCHAR(24) NOT NULL,
    priority INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    losses INTEGER NOT NULL,
    heartbeat_at TIMESTAMP WITH TIME ZONE,
    queue_job_id BIGINT,
    worker VARCHAR NOT NULL,
    cancel_requested BOOLEAN NOT NULL,
    progress JSONB NOT NULL,
    started_at TIMESTAMP WITH TIME ZONE,
    finished_at TIMESTAMP WITH TIME ZONE,
    error VARCHAR NOT NULL,
    failure JSONB,
    request_id VARCHAR NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_jobs PRIMARY KEY (id),
    CONSTRAINT ck_jobs_job_kind CHECK (kind IN ('inspect', 'analyse', 'predict', 'report', 'compare', 'norms')),
    CONSTRAINT fk_jobs_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_jobs_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT ck_jobs_job_status CHECK (status IN ('queued', 'running', 'succeeded', 'failed', 'cancelled'))
);

CREATE INDEX ix_jobs_created_at ON jobs (created_at);
CREATE INDEX ix_jobs_queue_job_id ON jobs (queue_job_id);
CREATE INDEX ix_jobs_session_id ON jobs (session_id);
CREATE INDEX ix_jobs_status_created_at ON jobs (status, created_at);
CREATE UNIQUE INDEX uq_jobs_input_hash ON jobs (kind, input_hash) WHERE status IN ('queued', 'running', 'succeeded');

CREATE TABLE recordings (
    session_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    sha256 CHAR(64) NOT NULL,
    size BIGINT NOT NULL,
    kind VARCHAR(24) NOT NULL,
    inspection JSONB,
    personal_entries VARCHAR[] NOT NULL,
    created_by UUID,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_recordings PRIMARY KEY (id),
    CONSTRAINT fk_recordings_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_recordings_sha256_stored_files FOREIGN KEY(sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT,
    CONSTRAINT ck_recordings_recording_kind CHECK (kind IN ('static', 'walk', 'other')),
    CONSTRAINT fk_recordings_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_recordings_created_at ON recordings (created_at);
CREATE INDEX ix_recordings_session_id ON recordings (session_id);
CREATE INDEX ix_recordings_sha256 ON recordings (sha256);

CREATE TABLE subjects (
    session_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    parameters JSONB NOT NULL,
    model_sha256 CHAR(64),
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_subjects PRIMARY KEY (id),
    CONSTRAINT fk_subjects_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_subjects_model_sha256_stored_files FOREIGN KEY(model_sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT
);

CREATE INDEX ix_subjects_created_at ON subjects (created_at);
CREATE INDEX ix_subjects_model_sha256 ON subjects (model_sha256);
CREATE INDEX ix_subjects_session_id ON subjects (session_id);

CREATE TABLE job_patients (
    job_id UUID NOT NULL,
    patient_id UUID NOT NULL,
    CONSTRAINT pk_job_patients PRIMARY KEY (job_id, patient_id),
    CONSTRAINT fk_job_patients_job_id_jobs FOREIGN KEY(job_id) REFERENCES jobs (id) ON DELETE RESTRICT,
    CONSTRAINT fk_job_patients_patient_id_patients FOREIGN KEY(patient_id) REFERENCES patients (id) ON DELETE RESTRICT
);

CREATE INDEX ix_job_patients_patient_id ON job_patients (patient_id);

CREATE TABLE results (
    job_id UUID NOT NULL,
    kind VARCHAR(24) NOT NULL,
    attempt INTEGER NOT NULL,
    provenance JSONB NOT NULL,
    session_id UUID,
    converged BOOLEAN NOT NULL,
    message VARCHAR NOT NULL,
    summary JSONB NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_results PRIMARY KEY (id),
    CONSTRAINT uq_results_job_id UNIQUE (job_id),
    CONSTRAINT fk_results_job_id_jobs FOREIGN KEY(job_id) REFERENCES jobs (id) ON DELETE RESTRICT,
    CONSTRAINT ck_results_job_kind CHECK (kind IN ('inspect', 'analyse', 'predict', 'report', 'compare', 'norms')),
    CONSTRAINT fk_results_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT
);

CREATE INDEX ix_results_created_at ON results (created_at);
CREATE INDEX ix_results_session_id ON results (session_id);

CREATE TABLE uploads (
    session_id UUID NOT NULL,
    user_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    size BIGINT NOT NULL,
    expires_at TIMESTAMP WITH TIME ZONE NOT NULL,
    media_type VARCHAR NOT NULL,
    sha256 CHAR(64),
    state VARCHAR(24) NOT NULL,
    recording_id UUID,
    attachment_id UUID,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_uploads PRIMARY KEY (id),
    CONSTRAINT fk_uploads_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_uploads_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT,
    CONSTRAINT ck_uploads_upload_state CHECK (state IN ('open', 'finished', 'abandoned')),
    CONSTRAINT fk_uploads_recording_id_recordings FOREIGN KEY(recording_id) REFERENCES recordings (id) ON DELETE RESTRICT,
    CONSTRAINT fk_uploads_attachment_id_attachments FOREIGN KEY(attachment_id) REFERENCES attachments (id) ON DELETE RESTRICT
);

CREATE INDEX ix_uploads_created_at ON uploads (created_at);
CREATE INDEX ix_uploads_expires_at ON uploads (expires_at);
CREATE INDEX ix_uploads_session_id ON uploads (session_id);
CREATE INDEX ix_uploads_user_id ON uploads (user_id);

CREATE TABLE cohort_members (
    cohort_id UUID NOT NULL,
    result_id UUID NOT NULL,
    "group" VARCHAR NOT NULL,
    CONSTRAINT pk_cohort_members PRIMARY KEY (cohort_id, result_id),
    CONSTRAINT fk_cohort_members_cohort_id_cohorts FOREIGN KEY(cohort_id) REFERENCES cohorts (id) ON DELETE RESTRICT,
    CONSTRAINT fk_cohort_members_result_id_results FOREIGN KEY(result_id) REFERENCES results (id) ON DELETE RESTRICT
);

CREATE INDEX ix_cohort_members_result_id ON cohort_members (result_id);

CREATE TABLE report_versions (
    session_id UUID NOT NULL,
    number INTEGER NOT NULL,
    result_id UUID,
    content JSONB NOT NULL,
    html_sha256 CHAR(64),
    pdf_sha256 CHAR(64),
    created_by UUID,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    version INTEGER NOT NULL,
    CONSTRAINT pk_report_versions PRIMARY KEY (id),
    CONSTRAINT uq_report_versions_session_id_number UNIQUE (session_id, number),
    CONSTRAINT fk_report_versions_session_id_sessions FOREIGN KEY(session_id) REFERENCES sessions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_report_versions_result_id_results FOREIGN KEY(result_id) REFERENCES results (id) ON DELETE RESTRICT,
    CONSTRAINT fk_report_versions_html_sha256_stored_files FOREIGN KEY(html_sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT,
    CONSTRAINT fk_report_versions_pdf_sha256_stored_files FOREIGN KEY(pdf_sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT,
    CONSTRAINT fk_report_versions_created_by_users FOREIGN KEY(created_by) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_report_versions_created_at ON report_versions (created_at);
CREATE INDEX ix_report_versions_html_sha256 ON report_versions (html_sha256);
CREATE INDEX ix_report_versions_pdf_sha256 ON report_versions (pdf_sha256);
CREATE INDEX ix_report_versions_result_id ON report_versions (result_id);

CREATE TABLE result_files (
    result_id UUID NOT NULL,
    name VARCHAR NOT NULL,
    media_type VARCHAR NOT NULL,
    sha256 CHAR(64) NOT NULL,
    size BIGINT NOT NULL,
    CONSTRAINT pk_result_files PRIMARY KEY (result_id, name),
    CONSTRAINT fk_result_files_result_id_results FOREIGN KEY(result_id) REFERENCES results (id) ON DELETE RESTRICT,
    CONSTRAINT fk_result_files_sha256_stored_files FOREIGN KEY(sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT
);

CREATE INDEX ix_result_files_sha256 ON result_files (sha256);

CREATE TABLE upload_chunks (
    upload_id UUID NOT NULL,
    "offset" BIGINT NOT NULL,
    size BIGINT NOT NULL,
    sha256 CHAR(64) NOT NULL,
    CONSTRAINT pk_upload_chunks PRIMARY KEY (upload_id, "offset"),
    CONSTRAINT fk_upload_chunks_upload_id_uploads FOREIGN KEY(upload_id) REFERENCES uploads (id) ON DELETE RESTRICT,
    CONSTRAINT fk_upload_chunks_sha256_stored_files FOREIGN KEY(sha256) REFERENCES stored_files (sha256) ON DELETE RESTRICT
);

CREATE INDEX ix_upload_chunks_sha256 ON upload_chunks (sha256);

CREATE TABLE report_signatures (
    report_id UUID NOT NULL,
    user_id UUID NOT NULL,
    document_sha256 CHAR(64) NOT NULL,
    meaning VARCHAR NOT NULL,
    id UUID NOT NULL,
    created_at TIMESTAMP WITH TIME ZONE DEFAULT now() NOT NULL,
    CONSTRAINT pk_report_signatures PRIMARY KEY (id),
    CONSTRAINT uq_report_signatures_report_id_user_id UNIQUE (report_id, user_id),
    CONSTRAINT fk_report_signatures_report_id_report_versions FOREIGN KEY(report_id) REFERENCES report_versions (id) ON DELETE RESTRICT,
    CONSTRAINT fk_report_signatures_user_id_users FOREIGN KEY(user_id) REFERENCES users (id) ON DELETE RESTRICT
);

CREATE INDEX ix_report_signatures_created_at ON report_signatures (created_at);
CREATE INDEX ix_report_signatures_user_id ON report_signatures (user_id);

-- The audit log only grows.
CREATE FUNCTION gaitlab_refuse_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    RAISE EXCEPTION 'the audit log cannot be changed';
END;
$$;

CREATE TRIGGER audit_log_only_grows BEFORE UPDATE OR DELETE ON audit_log
    FOR EACH ROW EXECUTE FUNCTION gaitlab_refuse_change();
