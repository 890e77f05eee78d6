# The explorer in a container: docker build -t hpsop . && docker run --rm -p 8080:8080 -v hpsop:/runs hpsop
# Any command of hpsop too: docker run --rm hpsop hpsop evaluate dtc-p4119
FROM python:3.11-slim-bookworm AS built
WORKDIR /src
COPY . .
# Exact versions, with the hash of every file where they are listed for this machine; no compiler is needed.
RUN python -m venv /opt/hpsop \
    && list="constraints/cp311-$(python -c 'import sysconfig; print(sysconfig.get_platform())').txt" \
    && if [ -f "$list" ]; then \
        /opt/hpsop/bin/pip install --no-cache-dir --require-hashes --requirement "$list" \
        && /opt/hpsop/bin/pip install --no-cache-dir --no-deps --no-build-isolation .; \
    else \
        /opt/hpsop/bin/pip install --no-cache-dir --constraint constraints.txt .; \
    fi

FROM python:3.11-slim-bookworm
COPY --from=built /opt/hpsop /opt/hpsop
# Runs, the page's token and compiled kernels stay in /runs; its owner is no administrator.
RUN useradd --create-home --uid 1000 hpsop && mkdir /runs && chown hpsop /runs
ENV PATH=/opt/hpsop/bin:$PATH HPSOP_RUNS=/runs NUMBA_CACHE_DIR=/runs/.kernels \
    OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 PYTHONUNBUFFERED=1
USER hpsop
WORKDIR /runs
EXPOSE 8080
# The page's address with its token is printed; 0.0.0.0 inside is what -p publishes, on the host's 127.0.0.1 if you say
# -p 127.0.0.1:8080:8080.
CMD ["hpsop-explore", "--host", "0.0.0.0", "--port", "8080", "--no-browser"]
