# SPDX-License-Identifier: Apache-2.0
# kerf-agent, for a machine with a device or for a simulated hand. Build from the repository's root:
#   docker build -f docker/agent.Dockerfile -t kerf-agent .
# The servo loop requests real-time scheduling; without it there is more jitter: --cap-add SYS_NICE --ulimit rtprio=80.
FROM debian:12-slim AS build
WORKDIR /kerf
COPY docker/machine.sh docker/packages.txt docker/
RUN docker/machine.sh install build
COPY CMakeLists.txt CMakePresets.json LICENSE CHANGELOG.md ./
COPY docker docker
COPY kernel kernel
COPY server server
COPY haptic_agent haptic_agent
RUN cmake --preset release -DKERF_TESTS=OFF \
 && cmake --build --preset release --target kerf-agent kerf-demo \
 && mkdir bin demo \
 && find build/release -type f -executable -name 'kerf-*' -exec cp {} bin/ ';' \
 && bin/kerf-demo demo \
 && docker/machine.sh libraries bin/kerf-agent >libraries.txt

FROM debian:12-slim
COPY --from=build /kerf/libraries.txt /tmp/
RUN apt-get update \
 && xargs apt-get install -y --no-install-recommends ca-certificates </tmp/libraries.txt \
 && rm -rf /var/lib/apt/lists/* && useradd --system kerf
COPY --from=build /kerf/bin/kerf-agent /usr/bin/
COPY --from=build /kerf/demo /usr/share/kerf/demo
USER kerf
ENTRYPOINT ["kerf-agent"]
