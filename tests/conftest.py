"""Property tests draw the same examples every time; rows of rods have a store of their own."""

import pytest
from hypothesis import settings

from figures import rows

settings.register_profile("steady", derandomize=True, deadline=None)
settings.load_profile("steady")


@pytest.fixture(scope="session", autouse=True)
def rows_store(tmp_path_factory):
    """Figures compute their rows anew, and leave nothing behind."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows, "STORE", tmp_path_factory.mktemp("rows") / "rows.db")
        yield
