"""Signing in at a real OpenID provider on loopback, and at one that cheats."""

import urllib.parse
import urllib.request

import pytest

from service.cli.__main__ import main
from tests.support.database import entered, sql
from tests.support.http_client import Browser
from tests.support.oidc import PUBLIC, Provider


@pytest.fixture(scope="module")
def provider():
    started = Provider()
    yield started
    started.stop()


@pytest.fixture(autouse=True)
def honest(provider):
    yield
    provider.tamper("")


def settings(url, provider, **changed):
    own = {
        "database_url": url,
        "oidc_issuer": provider.url,
        "oidc_client_id": "polhode",
        "oidc_client_secret": "s3cret",
    }
    return own | {"oidc_name": "Uni Ω"} | changed


@pytest.fixture(scope="module")
def server(new_app, url, provider):
    return new_app(**settings(url, provider))


@pytest.fixture(scope="module")
def by_mail(new_app, url, provider):
    return new_app(**settings(url, provider, oidc_claim="email"))


def sign_in(browser, subject, path="/oidc/login?next=/account"):
    """Status and page after the whole dance: to the provider, its form, and back."""
    status, page = browser.open(path)
    assert status == 200 and "Authorize Client" in page, page
    return browser.open(browser.at, sub=subject)


def test_the_whole_dance(server, url, provider):
    provider.user("s-1", preferred_username=" Zoe\u0308 ", name="Zoë")
    browser = Browser(server)
    status, page = browser.open("/login?next=/assignments/rigid-body")
    assert 'href="/oidc/login?next=/assignments/rigid-body"' in page and "Sign in with Uni Ω" in page
    browser.open("/oidc/login?next=/assignments/rigid-body")
    asked = urllib.parse.parse_qs(urllib.parse.urlsplit(browser.at).query)
    assert (
        asked["response_type"] == ["code"]
        and asked["code_challenge_method"] == ["S256"]
        and len(asked["nonce"][0]) >= 20
    )
    assert asked["redirect_uri"] == [f"{server.url}/oidc/callback"] and "openid" in asked["scope"][0]
    status, page = browser.open(browser.at, sub="s-1")
    assert status == 200 and browser.at == "/assignments/rigid-body" and "Zoë" in page
    assert sql(url, "SELECT role FROM member m JOIN person p ON p.id = person_id WHERE name = 'Zoë'") == [
        ("student",)
    ]
    assert sql(url, "SELECT issuer, subject FROM oidc_account") == [(provider.url, "s-1")]
    assert (
        "by Uni Ω <b>(this session)</b>" in browser.open("/account")[1]
        and browser.cookie("polhode_sign_in") is None
    )
    assert browser.cookie("polhode_session").has_nonstandard_attr("HttpOnly")


def test_a_path_too_long_for_a_cookie_is_left_out(server, provider):
    provider.user("s-90", preferred_username="liz")
    browser = Browser(server)
    assert sign_in(browser, "s-90", "/oidc/login?next=/account%3F" + 6000 * "a")[0] == 200 and browser.cookie(
        "polhode_session"
    )


def test_the_account_counts_and_not_its_name(server, url, provider):
    provider.user("s-2", preferred_username="ann")
    assert ">ann</dd>" in sign_in(Browser(server), "s-2")[1]
    provider.user("s-2", preferred_username="ann-married")
    assert ">ann</dd>" in sign_in(Browser(server), "s-2")[1], "the same person under another name there"
    provider.user("s-3", preferred_username="ann")
    status, page = sign_in(Browser(server), "s-3")
    assert status == 403 and "another account is linked to the name ann" in page
    assert sql(url, "SELECT count(*) FROM person WHERE name = 'ann-married'") == [(0,)]


def test_a_name_of_the_roster_is_claimed_with_its_role(server, url, provider):
    entered(url, "prof", "instructor")
    provider.user("s-4", preferred_username="prof")
    assert ">instructor</dd>" in sign_in(Browser(server), "s-4")[1]
    assert sql(url, "SELECT action FROM audit WHERE actor = 'prof'") == [("connect sign-in",)]


def test_a_name_with_a_password_is_connected_by_its_owner_only(server, url, provider, monkeypatch, capsys):
    entered(url, "ben", password="correct horse battery")
    provider.user("s-5", preferred_username="ben")
    status, page = sign_in(Browser(server), "s-5")
    assert status == 403 and "ben has a password here" in page
    other = Browser(server).log_in(token=entered(url, "eve"))
    assert sign_in(other, "s-5")[0] == 403 and ">eve</dd>" in other.open("/account")[1]
    owner = Browser(server).log_in(name="ben", password="correct horse battery")
    assert "Connect your account at Uni Ω" in owner.open("/account")[1]
    status, page = sign_in(owner, "s-5", "/oidc/login?next=%2Faccount%3Fdone%3Dconnected")
    assert status == 200 and "Account connected" in page and provider.url in page
    assert ">ben</dd>" in sign_in(Browser(server), "s-5")[1]
    monkeypatch.setenv("POLHODE_DATABASE_URL", url)
    assert (main(["unlink", "ben"]), capsys.readouterr().out) == (
        0,
        "the OpenID account of ben is unlinked\n",
    )
    assert owner.open("/v1/me")[0] == 401 and sign_in(Browser(server), "s-5")[0] == 403


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("unsigned", "unsupported_algorithm"),
        ("signed with what everybody knows", "unsupported_algorithm"),
        ("other claims", "bad_signature"),
        ("nonce", "invalid_claim"),
        ("expired", "expired_token"),
        ("for another client", "invalid_claim"),
        ("from another issuer", "invalid_claim"),
        ("no token", "sent no ID token"),
    ],
)
def test_what_the_provider_did_not_sign_for_this_login_is_refused(server, url, provider, how, why):
    provider.user("s-6", preferred_username="cas")
    provider.tamper(how)
    browser = Browser(server)
    status, page = sign_in(browser, "s-6")
    assert status == 403 and why in page, page
    assert browser.cookie("polhode_session") is None and sql(
        url, "SELECT count(*) FROM person WHERE name = 'cas'"
    ) == [(0,)]


def test_what_it_did_sign_is_taken_also_when_signed_by_these_tests(server, provider):
    provider.user("s-6", preferred_username="cas after all")
    provider.tamper("signed again")
    assert sign_in(Browser(server), "s-6")[0] == 200


def test_a_public_client_needs_no_secret(new_app, url, provider):
    server = new_app(**settings(url, provider, oidc_client_id=PUBLIC, oidc_client_secret=None))
    provider.user("s-13", preferred_username="ina")
    assert ">ina</dd>" in sign_in(Browser(server), "s-13")[1]


def test_a_provider_that_offers_tokens_without_signature_is_not_taken_at_its_word(new_app, url, provider):
    provider.tamper("offers none")
    server = new_app(**settings(url, provider))
    provider.user("s-7", preferred_username="dag")
    Browser(server).open("/oidc/login")  # it learns what is offered
    provider.tamper("unsigned")
    assert sign_in(Browser(server), "s-7")[0] == 403


class Stopping(Browser):
    """Stops at the way back from the provider."""

    def __init__(self, server, **headers):
        super().__init__(server, **headers)

        class Stay(urllib.request.HTTPRedirectHandler):
            def redirect_request(self, request, body, code, message, headers, address):
                return (
                    None
                    if "/oidc/callback" in address
                    else super().redirect_request(request, body, code, message, headers, address)
                )

        self._opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(self.cookies), Stay())

    def way_back(self, subject):
        self.open("/oidc/login")
        assert self.open(self.at, sub=subject)[0] == 302
        return self.answer["Location"]


def test_the_way_back_is_for_the_browser_that_went_and_for_once(server, provider):
    provider.user("s-8", preferred_username="fay")
    browser = Stopping(server)
    back = browser.way_back("s-8")
    for other, address in (
        (Browser(server), back),  # of somebody who did not go
        (Stopping(server), back),
        (browser, back.replace("state=", "state=x")),
    ):
        status, page = other.open(address)
        assert (
            status == 403
            and "was not started in this browser" in page
            and other.cookie("polhode_session") is None
        )
    attacker, victim = Stopping(server), Stopping(server)
    theirs = attacker.way_back("s-8")
    victim.way_back("s-8")
    assert victim.open(theirs)[0] == 403, "nobody is logged in as somebody else by a link"
    again = browser.way_back("s-8")
    assert browser.open(again)[0] == 200 and browser.open(again)[0] == 403


def test_a_forged_cookie_of_the_sign_in_is_refused(server, provider):
    browser = Stopping(server)
    back = browser.way_back("s-8")
    browser.cookie("polhode_sign_in").value = browser.cookie("polhode_sign_in").value[:-2] + "AA"
    assert browser.open(back)[0] == 403


def test_who_refuses_at_the_provider_is_told_so(server):
    browser = Browser(server)
    browser.open("/oidc/login")
    status, page = browser.open(browser.at, action="deny")
    assert status == 403 and "the sign-in provider refused the sign-in (access_denied)" in page
    state = "error=%3Cscript%3E&state=x"
    assert "<script>alert" not in browser.open(f"/oidc/callback?{state}")[1]


def test_an_address_counts_only_if_the_provider_has_verified_it(by_mail, url, provider):
    provider.user("s-9", email="gil@uni.example")
    status, page = sign_in(Browser(by_mail), "s-9")
    assert status == 403 and "has not verified your email address" in page
    provider.user("s-9", email="gil@uni.example", email_verified=True)
    assert ">gil@uni.example</dd>" in sign_in(Browser(by_mail), "s-9")[1]
    provider.user("s-10", email="x", email_verified="true")
    assert sign_in(Browser(by_mail), "s-10")[0] == 403


def test_who_has_no_name_there_is_told_so(server, provider):
    for claims in ({}, {"preferred_username": ""}, {"preferred_username": "\x00"}, {"preferred_username": 7}):
        provider.user("s-11", **claims)
        status, page = sign_in(Browser(server), "s-11")
        assert status == 403 and "did not send a usable name" in page, claims


def test_nobody_is_led_elsewhere_after_signing_in(server, provider):
    provider.user("s-12", preferred_username="hal")
    browser = Browser(server)
    assert sign_in(browser, "s-12", "/oidc/login?next=//evil.example")[0] == 200 and browser.at == "/"


@pytest.mark.parametrize("how", ["broken", "other issuer"])
def test_a_provider_that_is_not_what_it_should_be_gives_a_sentence(new_app, url, provider, how):
    server = new_app(**settings(url, provider))
    provider.tamper(how)
    status, page = Browser(server).open("/oidc/login")
    assert status == 503 and "the sign-in provider" in page
    provider.tamper("")
    assert "Authorize Client" in Browser(server).open("/oidc/login")[1], "it is asked again"


@pytest.fixture
def away():
    """A provider that goes away."""
    started = Provider()
    yield started
    started.stop()


@pytest.mark.slow
def test_a_provider_that_is_away_keeps_nobody_else_out(new_app, url, away):
    server, other = new_app(**settings(url, away)), new_app(**settings(url, away))
    browser = Stopping(server)
    back = browser.way_back("s-1")
    away.stop()
    for status, page in (browser.open(back), Browser(other).open("/oidc/login")):
        assert (
            status == 503 and "the sign-in provider does not respond" in page and "log in another way" in page
        )
    entered(url, "ida", password="correct horse battery")
    assert Browser(other).log_in(name="ida", password="correct horse battery").open("/v1/me")[0] == 200


def test_a_server_without_provider_has_no_such_page(new_app, url):
    server = new_app(database_url=url)
    assert [Browser(server).open(path)[0] for path in ("/oidc/login", "/oidc/callback")] == [404, 404]


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"POLHODE_OIDC_CLIENT_ID": ""}, "POLHODE_OIDC_ISSUER needs POLHODE_OIDC_CLIENT_ID"),
        ({"POLHODE_IDENTITY": "local"}, "POLHODE_OIDC_ISSUER needs POLHODE_IDENTITY=token"),
        ({"POLHODE_OIDC_ISSUER": "http://uni.example"}, "the issuer must be an address https://"),
    ],
)
def test_settings_that_cannot_work_are_reported_at_the_start(tmp_path, monkeypatch, capsys, changed, why):
    own = {
        "POLHODE_IDENTITY": "token",
        "POLHODE_OIDC_ISSUER": "https://uni.example",
        "POLHODE_DATA": str(tmp_path / "data"),
    }
    own |= {"POLHODE_OIDC_CLIENT_ID": "polhode", "POLHODE_OIDC_CLIENT_SECRET": "s3cret"}
    for name, value in (own | changed).items():
        monkeypatch.setenv(name, value)
    assert main(["serve", "--port", "0"]) == 2
    told = capsys.readouterr().err
    assert why in told and "s3cret" not in told and not (tmp_path / "data").exists()


def test_packages_that_are_missing_are_named(monkeypatch):
    from service.auth import oidc
    from service.settings import Settings

    monkeypatch.setattr(oidc.importlib.util, "find_spec", lambda name: None)
    given = Settings(identity="token", oidc_issuer="https://uni.example", oidc_client_id="x")
    with pytest.raises(
        oidc.NotInstalled, match="needs authlib and httpx2: install polhode's wheel with its extra oidc"
    ):
        oidc.provider(given)
    assert oidc.provider(Settings()) is None
