# SPDX-License-Identifier: Apache-2.0
"""The manifests of several servers start servers that share their sessions.

The programs are those of the build, on this machine: addresses, folders and the scene are replaced,
everything else is as the manifest says. No container engine is needed.
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "server"))

import nats_server  # noqa: E402

try:
    import yaml
except ImportError:
    print("skipped: python3-yaml is not installed")
    sys.exit(77)

from cluster_servers import is_copied_to  # noqa: E402
from kept_logs import Output, run_tests  # noqa: E402
from live_server import PROGRAM, SCENE, until  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import Http  # noqa: E402

UID = 10001  # of the image


def documents(name):
    with open(os.path.join(ROOT, "docker", name), encoding="utf-8") as file:
        return list(yaml.safe_load_all(file))


class Node:
    """A kerf-server with the environment and the words of a manifest."""

    def __init__(self, folder, environment, words, nats):
        self.port = nats_server.free_port()
        self.name = environment["KERF_NODE"]
        environment = {**environment, "KERF_LISTEN": f"127.0.0.1:{self.port}", "KERF_NATS": nats,
                       "KERF_DATA": os.path.join(folder, self.name)}
        scene = os.path.join(folder, "demo.json")
        with open(scene, "w", encoding="ascii") as file:
            json.dump(SCENE, file)
        words = [scene if word.endswith("/demo.json") else word for word in words]
        inherited = {k: v for k, v in os.environ.items() if not k.startswith("KERF_")}
        self.process = subprocess.Popen([PROGRAM, *words], env={**inherited, **environment},
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.log = Output(self.process.stderr, "server")
        line = self.process.stdout.readline()
        if not line.startswith("http://"):
            raise RuntimeError(self.log.whole())
        self.http = Http(self.port)
        token = environment.get("KERF_ADMIN_TOKEN")
        self.headers = {"Authorization": f"Bearer {token}"} if token else {}

    def ask(self, method, path, body=None, **headers):
        return self.http.request(method, path, body, {**self.headers, **headers})

    def stop(self, how=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(how)
        self.process.wait(timeout=60)
        self.process.stdout.close()


class Manifest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(self.folder.cleanup)
        self.nats = nats_server.Nats(os.path.join(self.folder.name, "nats"))
        self.addCleanup(self.nats.stop)

    def start(self, servers):
        nodes = []
        for environment, words in servers:
            nodes.append(Node(self.folder.name, environment, words, self.nats.url))
            self.addCleanup(nodes[-1].stop, signal.SIGKILL)
        return nodes

    def listed(self, node):
        answer = json.loads(node.ask("GET", "/v1/sessions")[2])
        return [(s["id"], s["node"]) for s in answer.get("sessions", [])]

    def is_copied(self, node, session):
        info = json.loads(node.ask("GET", f"/v1/sessions/{session}")[2])
        return is_copied_to(info, info["state_sequence"])

    def check_takeover(self, nodes, owner):
        """The session is at `owner`, all know it, and another one goes on when it is gone."""
        session, name = "block", owner.name
        for node in nodes:
            until(self, lambda n=node: self.listed(n), [(session, name)])
        # A server that is gone before NATS has the session takes it along.
        until(self, lambda: self.is_copied(owner, session), True)
        other = next(node for node in nodes if node is not owner)
        status, headers, _ = other.ask("GET", f"/v1/sessions/{session}")
        self.assertEqual(status, 307)
        owner.stop(signal.SIGKILL)
        left = [node for node in nodes if node is not owner]
        eventually(lambda: any(n.ask("GET", f"/v1/sessions/{session}")[0] == 200 for n in left),
                   "no other server goes on with the session", 60)
        return headers["location"]

    def test_compose(self):
        manifest = documents("cluster.yaml")[0]
        services = {k: v for k, v in manifest["services"].items() if k != "nats"}
        self.assertEqual(len(services), 3)
        for name, service in services.items():
            self.assertEqual(service["environment"]["KERF_NODE"], name)
            port = service["environment"]["KERF_LISTEN"].rpartition(":")[2]
            self.assertEqual(service["ports"], [f"{port}:{port}", f"{port}:{port}/udp"])
            self.assertEqual(service["environment"]["KERF_ADVERTISE"], f"http://localhost:{port}")
            self.assertTrue(service["read_only"])
            volume, path = service["volumes"][0].split(":")
            self.assertIn(volume, manifest["volumes"])
            self.assertEqual(path, "/var/lib/kerf")
            self.assertIn("memory", service["deploy"]["resources"]["limits"])
        self.assertEqual(len({s["volumes"][0] for s in services.values()}), 3)
        self.assertTrue(all(s["environment"]["KERF_NATS"] == "nats://nats:4222"
                            for s in services.values()))
        nodes = self.start([(s["environment"], s["command"]) for s in services.values()])
        place = self.check_takeover(nodes, nodes[0])
        self.assertEqual(place, "http://localhost:8081/v1/sessions/block")

    @staticmethod
    def environment(container, pod):
        """As a kubelet makes it: values may name variables before them."""
        known = {}
        for entry in container["env"]:
            if "value" in entry:
                value = re.sub(r"\$\((\w+)\)", lambda m: known[m[1]], entry["value"])
            elif "fieldRef" in entry["valueFrom"]:
                assert entry["valueFrom"]["fieldRef"]["fieldPath"] == "metadata.name"
                value = pod
            else:
                value = "secret-of-the-test-0123456789abcdef"
            known[entry["name"]] = value
        return known

    def test_kubernetes(self):
        kinds = {}
        for document in documents("kubernetes.yaml"):
            kinds.setdefault(document["kind"], {})[document["metadata"]["name"]] = document
        for name, state in kinds["StatefulSet"].items():
            self.check_pod(name, state["spec"], kinds)
        spec = kinds["StatefulSet"]["kerf"]["spec"]
        pod = spec["template"]["spec"]
        self.assertEqual(pod["securityContext"]["runAsUser"], UID)
        self.assertEqual(pod["securityContext"]["fsGroup"], UID)
        self.assertFalse(pod["enableServiceLinks"], "KERF_PORT would be an option")
        self.assertTrue(kinds["Service"]["kerf"]["spec"]["publishNotReadyAddresses"])
        container = pod["containers"][0]
        names = [f"kerf-{n}" for n in range(spec["replicas"])]
        environments = [self.environment(container, name) for name in names]
        self.assertEqual(environments[0]["KERF_NATS"], "nats://nats:4222")
        nodes = self.start([(e, container.get("args", [])) for e in environments])
        for kind in ("startupProbe", "livenessProbe", "readinessProbe"):
            path = container[kind]["httpGet"]["path"]  # a kubelet addresses a pod by its number
            until(self, lambda p=path: nodes[0].http.request("GET", p)[0], 200)
        host = "kerf-1.kerf.default.svc.cluster.local:8080"
        scene = json.dumps(SCENE)
        status, _, body = nodes[1].ask("POST", "/v1/sessions?here=1", scene, Host=host)
        self.assertEqual(status, 201, body)
        self.assertEqual(nodes[1].ask("GET", "/v1/sessions", Host="elsewhere:8080")[0], 421)
        self.assertEqual(self.check_takeover(nodes, nodes[1]),
                         f"http://{host}/v1/sessions/block")

    def check_pod(self, name, spec, kinds):
        """What a cluster would find out only when it runs."""
        pod, labels = spec["template"]["spec"], spec["template"]["metadata"]["labels"]
        self.assertEqual(spec["selector"]["matchLabels"], labels)
        service = kinds["Service"][spec["serviceName"]]["spec"]
        self.assertEqual(service["selector"], labels)
        self.assertEqual(service["clusterIP"], "None")
        self.assertTrue(pod["securityContext"]["runAsNonRoot"])
        volumes = {v["name"] for v in pod.get("volumes", [])} | {
            v["metadata"]["name"] for v in spec["volumeClaimTemplates"]}
        for container in pod["containers"]:
            ports = {p["name"] for p in container["ports"]}
            self.assertLessEqual({p["name"] for p in service["ports"]}, ports, name)
            for kind in ("startupProbe", "livenessProbe", "readinessProbe"):
                self.assertIn(container[kind]["httpGet"]["port"], ports)
            self.assertIn("memory", container["resources"]["limits"])
            self.assertTrue(container["securityContext"]["readOnlyRootFilesystem"])
            self.assertFalse(container["securityContext"]["allowPrivilegeEscalation"])
            mounts = {m["name"] for m in container["volumeMounts"]}
            self.assertEqual(mounts, volumes)

    def test_the_image_has_the_user_of_the_manifest(self):
        with open(os.path.join(ROOT, "docker", "kerf.Dockerfile"), encoding="utf-8") as file:
            self.assertIn(f"useradd --system --uid {UID} ", file.read())


if __name__ == "__main__":
    if nats_server.PROGRAM is None:
        print("skipped: nats-server is not installed")
        sys.exit(77)
    run_tests()
