from gaitlab.api.passwords import _DUMMY, hash_password, verify_password


def test_an_unknown_account_costs_as_much_as_a_known_one():
    # Version, memory, passes and lanes stand before salt and hash.
    assert _DUMMY.split("$")[:4] == hash_password("a long enough password").split("$")[:4]
    assert verify_password("a long enough password", None) == (False, None)
