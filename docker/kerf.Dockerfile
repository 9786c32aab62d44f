# SPDX-License-Identifier: Apache-2.0
# The images of kerf-server, with its page, and of kerf-agent. Build from the repository's root:
#   docker build -f docker/kerf.Dockerfile --target server -t kerf-server .
#   docker build -f docker/kerf.Dockerfile --target agent -t kerf-agent .
# Both take their programs from one stage, and the page and its kernel are stages of their own: an edit of the page
# compiles no C++.

FROM debian:12-slim AS wasm
WORKDIR /kerf
COPY docker/machine.sh docker/packages.txt docker/
RUN docker/machine.sh install build wasm
COPY CMakeLists.txt CMakePresets.json ./
COPY kernel kernel
COPY server server
COPY haptic_agent haptic_agent
COPY web/wasm web/wasm
RUN cmake --preset wasm && cmake --build --preset wasm \
 && cmake --preset wasm-files && cmake --build --preset wasm-files

FROM debian:12-slim AS web
WORKDIR /kerf
COPY docker/machine.sh docker/packages.txt docker/
RUN docker/machine.sh install node
COPY web web
COPY server/http/openapi.json server/http/
COPY --from=wasm /kerf/web/public/*.wasm web/public/
RUN docker/machine.sh page

FROM debian:12-slim AS programs
WORKDIR /kerf
COPY docker/machine.sh docker/packages.txt docker/
RUN docker/machine.sh install build
COPY CMakeLists.txt CMakePresets.json LICENSE CHANGELOG.md ./
COPY docker docker
COPY kernel kernel
COPY server server
COPY haptic_agent haptic_agent
RUN cmake --preset release -DKERF_TESTS=OFF \
 && cmake --build --preset release --target kerf-server kerf-carve kerf-agent kerf-demo \
 && mkdir bin demo libraries \
 && strip -o bin/kerf-server build/release/bin/kerf-server \
 && strip -o bin/kerf-carve build/release/bin/kerf-carve \
 && strip -o bin/kerf-agent build/release/bin/kerf-agent \
 && build/release/bin/kerf-demo demo && cp haptic_agent/demo/demo.json demo/ \
 && for program in server agent; do docker/machine.sh libraries bin/kerf-$program >libraries/$program; done

FROM debian:12-slim AS base
# Both images use one user with a fixed number, so that a host's folder can be given to it before
# the first start.
RUN useradd --system --uid 10001 --create-home --home-dir /var/lib/kerf kerf
LABEL org.opencontainers.image.version="0.2.0" \
      org.opencontainers.image.licenses="Apache-2.0"

FROM base AS server
COPY --from=programs /kerf/libraries/server /tmp/libraries
RUN apt-get update \
 && xargs apt-get install -y --no-install-recommends curl </tmp/libraries \
 && rm -rf /var/lib/apt/lists/* /tmp/libraries
COPY --from=programs /kerf/bin/kerf-server /kerf/bin/kerf-carve /usr/bin/
COPY --from=programs /kerf/demo /usr/share/kerf/demo
COPY --from=web /kerf/web/dist /usr/share/kerf/web
LABEL org.opencontainers.image.title="kerf-server" \
      org.opencontainers.image.description="Collaborative haptic sculpting: the server and its page"
USER kerf
VOLUME /var/lib/kerf
# Defaults. Options and `-e` replace them. The health check follows KERF_LISTEN.
ENV KERF_LISTEN=0.0.0.0:8080 KERF_DATA=/var/lib/kerf
EXPOSE 8080 8080/udp
HEALTHCHECK --interval=5s --timeout=3s --start-period=60s \
  CMD curl -fsS "http://127.0.0.1:${KERF_LISTEN##*:}/healthz"
ENTRYPOINT ["kerf-server"]

# The servo loop requests real-time scheduling and locked memory: --ulimit rtprio=90 --ulimit memlock=-1.
# A USB device: --device /dev/bus/usb.
FROM base AS agent
COPY --from=programs /kerf/libraries/agent /tmp/libraries
RUN apt-get update \
 && xargs apt-get install -y --no-install-recommends ca-certificates </tmp/libraries \
 && rm -rf /var/lib/apt/lists/* /tmp/libraries
COPY --from=programs /kerf/bin/kerf-agent /usr/bin/
COPY --from=programs /kerf/demo /usr/share/kerf/demo
LABEL org.opencontainers.image.title="kerf-agent" \
      org.opencontainers.image.description="Collaborative haptic sculpting: the 1 kHz loop beside a device"
USER kerf
ENTRYPOINT ["kerf-agent"]
