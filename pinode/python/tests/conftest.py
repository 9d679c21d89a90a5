"""What several tests look at."""

import frame_testing
import pytest

import pinode


def record(name, losses=(0.0, 0.0, 0.0), seed=1, samples=1500):
    ground, floors = frame_testing.measure(losses, seed, samples)
    return pinode.Record(
        name, step=frame_testing.STEP, ground={"x": ground},
        interpolation="cubic", start="rest",
        channels=pinode.channels("a", floors, "absolute_acceleration"))


def model():
    return pinode.Model(frame_testing.MASS, frame_testing.STIFFNESS,
                        frame_testing.DAMPING)


def groups():
    return [pinode.Group(f"k{i + 1}", matrix)
            for i, matrix in enumerate(frame_testing.STOREYS)]


@pytest.fixture(scope="session")
def healthy():
    """The case of the frame as it was."""
    return pinode.Case(model(), groups=groups(), records=[record("healthy")])


@pytest.fixture(scope="session")
def baseline(healthy):
    return healthy.identify()


@pytest.fixture(scope="session")
def damaged(healthy):
    """The case of the frame whose first storey has lost a tenth."""
    return healthy.replace(records=[record("now", (0.1, 0.0, 0.0), seed=2)])
