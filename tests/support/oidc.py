"""An OpenID provider as its own process on loopback, oidc-provider-mock; on request it misbehaves in ways a
client has to notice.

It also holds its clients to PKCE, which the package does not: the verifier must be the one the challenge was
made of.
"""

import base64
import hmac
import io
import json
import os
import subprocess
import sys
import threading
import time
import urllib.parse
import urllib.request
from hashlib import sha256

from service.cli.server.demo import free_port

PUBLIC = "a public client"


class Provider:
    """It ends with this process. ``tamper`` tells what it does to the next answers, "" for nothing; see
    ``Tampering``.
    """

    def __init__(self):
        self.port = free_port()
        self.url = f"http://localhost:{self.port}"
        self.start()

    def start(self):
        command = [sys.executable, "-W", "ignore", "-m", "tests.support.oidc", str(self.port)]
        environment = os.environ | {"AUTHLIB_INSECURE_TRANSPORT": "1"}
        self.process = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                return urllib.request.urlopen(f"{self.url}/jwks", timeout=5).close()
            except OSError:
                time.sleep(0.05)
        raise AssertionError("no provider")

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
        self.process.stdin.close()
        self.process.wait(30)

    def user(self, subject, **claims):
        """Somebody who has an account there."""
        self._put(f"/users/{subject}", claims)

    def tamper(self, how):
        self._put("/tamper", {"how": how})

    def _put(self, path, document):
        headers = {"Content-Type": "application/json"}
        urllib.request.urlopen(
            urllib.request.Request(self.url + path, json.dumps(document).encode(), headers, method="PUT"),
            timeout=10,
        ).close()


class Tampering:
    """WSGI around the provider."""

    def __init__(self, app):
        self.app, self.how, self.challenges = app, "", {}

    def __call__(self, environ, start_response):
        path = environ["PATH_INFO"]
        if path == "/tamper":
            self.how = json.loads(environ["wsgi.input"].read(int(environ["CONTENT_LENGTH"])))["how"]
            start_response("204 No Content", [])
            return [b""]
        if path == "/oauth2/authorize":
            return self._authorize(environ, start_response)
        if path == "/oauth2/token":
            return self._token(environ, start_response)
        if path == "/.well-known/openid-configuration" and self.how in (
            "broken",
            "other issuer",
            "offers none",
        ):
            return self._discovery(environ, start_response)
        return self.app(environ, start_response)

    def _authorize(self, environ, start_response):
        asked = dict(urllib.parse.parse_qsl(environ["QUERY_STRING"]))
        assert asked["code_challenge_method"] == "S256" and asked["state"] and asked["nonce"]
        if self.how == "nonce":
            environ["QUERY_STRING"] = urllib.parse.urlencode(asked | {"nonce": "of somebody else"})

        def keep(status, headers, error=None):
            gone_to = dict(headers).get("Location", "")
            if code := urllib.parse.parse_qs(urllib.parse.urlsplit(gone_to).query).get("code"):
                self.challenges[code[0]] = asked["code_challenge"]
            return start_response(status, headers, error)

        return self.app(environ, keep)

    def _token(self, environ, start_response):
        body = environ["wsgi.input"].read(int(environ["CONTENT_LENGTH"]))
        sent = dict(urllib.parse.parse_qsl(body.decode()))
        challenge = (
            base64.urlsafe_b64encode(sha256(sent.get("code_verifier", "").encode()).digest())
            .rstrip(b"=")
            .decode()
        )
        if challenge != self.challenges.pop(sent.get("code"), None):
            start_response("400 Bad Request", [("Content-Type", "application/json")])
            return [b'{"error": "invalid_grant"}']
        if (
            "HTTP_AUTHORIZATION" not in environ
            and sent.get("client_id") == PUBLIC
            and "client_secret" not in sent
        ):
            body += b"&client_secret=any"  # the package knows no public clients, but takes any secret
            environ["CONTENT_LENGTH"] = str(len(body))
        environ["wsgi.input"] = _Body(body)
        status, answer = self._asked(environ)
        if (token := answer.pop("id_token", None)) and self.how != "no token":
            answer["id_token"] = self._changed(token)
        start_response(status, [("Content-Type", "application/json")])
        return [json.dumps(answer).encode()]

    def _discovery(self, environ, start_response):
        status, told = self._asked(environ)
        if self.how == "other issuer":
            told["issuer"] = "https://other.example"
        if self.how == "offers none":
            told["id_token_signing_alg_values_supported"] = ["none", "HS256"]
        start_response(status, [("Content-Type", "application/json")])
        return [b"<html>" if self.how == "broken" else json.dumps(told).encode()]

    def _asked(self, environ):
        """Status and document that the provider itself answers."""
        found = []
        body = b"".join(self.app(environ, lambda status, headers, error=None: found.append(status)))
        return found[0], json.loads(body)

    def _changed(self, token):
        head, claims, signature = token.split(".")
        told = json.loads(_decoded(claims))
        if self.how == "unsigned":
            return f"{_encoded({'alg': 'none'})}.{claims}."
        if self.how == "signed with what everybody knows":
            public = urllib.request.urlopen(f"{told['iss']}/jwks", timeout=10).read()
            signed = f"{_encoded({'alg': 'HS256'})}.{claims}"
            made = base64.urlsafe_b64encode(hmac.digest(public, signed.encode(), "sha256"))
            return f"{signed}.{made.rstrip(b'=').decode()}"
        if self.how == "other claims":
            return f"{head}.{_encoded(told | {'preferred_username': 'prof'})}.{signature}"
        if self.how in _SIGNED:
            return self._signed(_decoded(head), told | _SIGNED[self.how])
        return token

    def _signed(self, head, claims):
        """Signed by the provider's own key, which lies in the state of its application."""
        from joserfc import jwk, jwt

        return jwt.encode(json.loads(head), claims, jwk.RSAKey.import_key(self.app.own_key()))


_SIGNED = {
    "signed again": {},
    "expired": {"exp": 1_000_000_000},
    "for another client": {"aud": "somebody else", "azp": "somebody else"},
    "from another issuer": {"iss": "https://other.example"},
}


class _Body:
    def __init__(self, content):
        self.read = io.BytesIO(content).read


def _decoded(part):
    return base64.urlsafe_b64decode(part + "=" * (-len(part) % 4))


def _encoded(document):
    return base64.urlsafe_b64encode(json.dumps(document).encode()).rstrip(b"=").decode()


def main(port):
    import oidc_provider_mock
    import werkzeug.serving

    app = oidc_provider_mock.app()

    def own_key():
        from oidc_provider_mock._storage import storage

        with app.test_request_context():
            app.preprocess_request()
            # with the private part; the class of the key depends on the package's version
            return storage.jwk.as_pem(True)

    def serve(environ, start_response):
        return app.wsgi_app(environ, start_response)

    serve.own_key = own_key
    server = werkzeug.serving.make_server("localhost", port, Tampering(serve), threaded=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    sys.stdin.buffer.read()  # it ends when whoever started us is gone


if __name__ == "__main__":
    main(int(sys.argv[1]))
