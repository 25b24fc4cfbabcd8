"""Whether a provider may be believed about who somebody is: signature, issuer, audience, time and our nonce."""

from collections.abc import Mapping
from typing import Any

from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet
from joserfc.jwt import JWTClaimsRegistry

from ..errors import NotSignedIn
from ..storage.settings import Settings

ALGORITHMS = ("RS256", "PS256", "ES256", "EdDSA")
LEEWAY = 60
"""Difference of clocks that is allowed [s]."""


def checked_claims(token: str, keys: Any, nonce: str, settings: Settings) -> Mapping[str, Any]:
    """The claims of a token that one of the provider's keys has signed; raises NotSignedIn for any doubt."""
    try:
        found = jwt.decode(token, KeySet.import_key_set(keys), algorithms=list(ALGORITHMS))
        JWTClaimsRegistry(
            leeway=LEEWAY,
            iss={"essential": True, "value": settings.oidc_issuer},
            aud={"essential": True, "value": settings.oidc_client_id},
            exp={"essential": True},
            sub={"essential": True},
            nonce={"essential": True, "value": nonce},
        ).validate(found.claims)
    except (JoseError, ValueError, KeyError, TypeError) as error:
        raise NotSignedIn("the single sign-on provider's answer cannot be believed: begin again") from error
    return found.claims
