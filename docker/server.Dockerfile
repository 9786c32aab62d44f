# SPDX-License-Identifier: Apache-2.0
# kerf-server with the web viewer. Build from the repository's root:
#   docker build -f docker/server.Dockerfile -t kerf-server .
FROM debian:12-slim AS build
WORKDIR /kerf
COPY docker/machine.sh docker/packages.txt docker/
RUN docker/machine.sh install build node
COPY web web
RUN docker/machine.sh web
COPY CMakeLists.txt CMakePresets.json LICENSE CHANGELOG.md ./
COPY docker docker
COPY kernel kernel
COPY server server
COPY haptic_agent haptic_agent
RUN cmake --preset release -DKERF_TESTS=OFF \
 && cmake --build --preset release --target kerf-server kerf-carve kerf-demo \
 && mkdir bin demo \
 && find build/release -type f -executable -name 'kerf-*' -exec cp {} bin/ ';' \
 && bin/kerf-demo demo && cp haptic_agent/demo/demo.json demo/ \
 && docker/machine.sh libraries bin/kerf-server >libraries.txt

FROM debian:12-slim
COPY --from=build /kerf/libraries.txt /tmp/
RUN apt-get update \
 && xargs apt-get install -y --no-install-recommends curl </tmp/libraries.txt \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --create-home --home-dir /var/lib/kerf kerf
COPY --from=build /kerf/bin/kerf-server /kerf/bin/kerf-carve /usr/bin/
COPY --from=build /kerf/web/dist /usr/share/kerf/web
COPY --from=build /kerf/demo /usr/share/kerf/demo
USER kerf
VOLUME /var/lib/kerf
EXPOSE 8080 8080/udp
HEALTHCHECK CMD curl -fsS http://127.0.0.1:8080/healthz
ENTRYPOINT ["kerf-server", "--listen", "0.0.0.0:8080", "--data", "/var/lib/kerf", "--web", "/usr/share/kerf/web"]
