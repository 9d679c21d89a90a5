# From matrices and arrays to a verdict on damage, with figures. `measurements`
# are a frame's mass, damping, stiffness (3 x 3) and what each storey adds to
# the stiffness, and by day the accelerations of the ground and of the floors.
import pinode
from measurements import DAMPING, MASS, STIFFNESS, STOREYS, last_year, today


def record(name, ground, floors):
    return pinode.Record(
        name, step=0.01, ground={"x": ground}, interpolation="cubic", start="rest",
        channels=pinode.channels("a", floors, "absolute_acceleration"))


healthy = pinode.Case(
    pinode.Model(MASS, STIFFNESS, DAMPING),
    groups=[pinode.Group(f"k{i + 1}", matrix) for i, matrix in enumerate(STOREYS)],
    records=[record("last_year", *last_year)])
baseline = healthy.identify()
damage = healthy.replace(records=[record("today", *today)]).damage([baseline])
print(damage.sentence)
for name, figure in damage.figures().items():
    figure.savefig(f"{name}.png")
damage.save("frame")
