"""Tokens and logins in the store: which are good, who may revoke them, and that a login is confirmed once."""

import pytest

from service.store.people import tokens
from tests.support.database import run


def in_transaction(url, action):
    """Return what ``action(connection)`` returns in one transaction."""

    async def begun(database):
        async with database.begin() as connection:
            return await action(connection)

    return run(url, begun)


def given(url, name, seconds=1000.0):
    return in_transaction(
        url, lambda c: tokens.create(c, name, label="test", scopes=["read"], seconds=seconds)
    )


def found(url, token):
    return run(url, lambda d: tokens.find(d, token))


def test_a_token_is_good_until_it_expires(url):
    good, old = found(url, given(url, "ann")), found(url, given(url, "ann", seconds=-1.0))
    assert (good.person, good.scopes, good.over) == ("ann", {"read"}, None)
    assert old.over.startswith("expired on 20")
    assert found(url, "polhode_unknown") is None


def test_a_revoked_token_is_not_good(url):
    token, other = given(url, "ben"), given(url, "cleo")
    assert in_transaction(url, lambda c: tokens.revoke(c, person="ben")) == 1
    assert found(url, token).over.startswith("was revoked on 20") and found(url, other).over is None


def test_only_its_owner_revokes_a_token_of_their_own(url):
    token = given(url, "dora")
    id = found(url, token).id
    assert not in_transaction(url, lambda c: tokens.revoke_own(c, "eve", id))
    assert found(url, token).over is None
    assert in_transaction(url, lambda c: tokens.revoke_own(c, "dora", id))
    assert found(url, token).over and not in_transaction(url, lambda c: tokens.revoke_own(c, "dora", id))


def test_a_login_is_confirmed_by_one_person_and_collected_once(url):
    device, code = run(url, lambda d: tokens.create_login(d, "a notebook"))
    assert run(url, lambda d: tokens.collect_login(d, device, 1.0)) is None, "nobody has confirmed it"
    assert run(url, lambda d: tokens.confirm_login(d, code, "fay"))
    assert not run(url, lambda d: tokens.confirm_login(d, code, "mallory"))
    token, person = run(url, lambda d: tokens.collect_login(d, device, 1.0))
    assert person == "fay" and found(url, token).person == "fay"
    with pytest.raises(tokens.LoginOver):
        run(url, lambda d: tokens.collect_login(d, device, 1.0))


def test_a_refused_login_gives_no_token(url):
    device, code = run(url, lambda d: tokens.create_login(d, "a notebook"))
    assert run(url, lambda d: tokens.confirm_login(d, code, None))
    assert not run(url, lambda d: tokens.confirm_login(d, code, "gus"))
    with pytest.raises(tokens.LoginOver):
        run(url, lambda d: tokens.collect_login(d, device, 1.0))


def test_the_oldest_unconfirmed_logins_make_place_for_new_ones(database_url, monkeypatch):
    monkeypatch.setattr(tokens, "MOST_PENDING", 3)
    logins = [run(database_url, lambda d, k=k: tokens.create_login(d, str(k))) for k in range(3)]
    assert run(database_url, lambda d: tokens.confirm_login(d, logins[0][1], "ann"))
    logins += [run(database_url, lambda d, k=k: tokens.create_login(d, str(k))) for k in range(3, 6)]
    found = [run(database_url, lambda d, code=code: tokens.find_login(d, code)) for _, code in logins]
    assert found == [None, None, None, "3", "4", "5"]
    assert run(database_url, lambda d: tokens.collect_login(d, logins[0][0], 1.0))[1] == "ann", (
        "confirmed in time"
    )
