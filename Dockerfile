# gaitlab as a service: `docker build -t gaitlab .`, see docs/deploy.md.

FROM python:3.12-slim AS build
RUN apt-get update \
    && apt-get install --yes --no-install-recommends gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
RUN python -m venv /opt/gaitlab/venv
ENV PATH=/opt/gaitlab/venv/bin:$PATH OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
WORKDIR /source
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY data data
COPY frontend frontend
COPY gaitlab gaitlab
RUN pip install --no-cache-dir --disable-pip-version-check -c constraints.txt '.[server,parquet]'
# The derivatives of the walk are compiled here: an analysis finds them and the image needs no compiler.
ENV GAITLAB_CACHE=/opt/gaitlab/cache
RUN gaitlab demo --out /tmp/demo && rm -rf /tmp/demo

FROM python:3.12-slim
RUN useradd --system --uid 10001 --no-create-home --shell /usr/sbin/nologin gaitlab \
    && install -d -o gaitlab -g gaitlab -m 700 /data
COPY --from=build /opt/gaitlab /opt/gaitlab
# `true` in place of a compiler: compiled derivatives are used, new ones are interpreted.
ENV PATH=/opt/gaitlab/venv/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
    GAITLAB_CACHE=/opt/gaitlab/cache GAITLAB_COMPILER=true \
    GAITLAB_DATA_DIR=/data GAITLAB_HOST=0.0.0.0 GAITLAB_PORT=8000 \
    HOME=/data MPLCONFIGDIR=/tmp/matplotlib
USER gaitlab
VOLUME /data
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=15s --timeout=5s --start-period=60s --retries=4 \
    CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8000/health/live', timeout=4)"]
ENTRYPOINT ["gaitlab"]
CMD ["serve"]
