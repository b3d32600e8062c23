"""All cases by name, with the answer when each was first met."""

from __future__ import annotations

from cases import on_rig, sensors, storeys
from cases.in_water import Scene, in_water
from cases.trial import Case

CASES: dict[str, Case] = {
    case.name: case
    for case in (
        Case(
            "thick_plate",
            "named damping_patch, local_stiffness, over 99.9 %",
            on_rig.thick_plate("kirchhoff"),
        ),
        Case("thick_plate_mindlin", "no such theory for plates", on_rig.thick_plate("mindlin")),
        Case("tank", "unknown, though 77 % -> 0.35 %", on_rig.stated_tank),
        Case("free_layer", "unknown", on_rig.free_layer()),
        Case("free_E_layer", "named fluid_added_mass", on_rig.free_layer("E")),
        Case("one_accelerometer", "none", sensors.one_off),
        Case("tip_mass", "named clamp_rotation, 99.9 %", on_rig.tip_mass),
        Case("frame_softer", "unknown", storeys.storeys(2, 0.8, 0.8)),
        Case("two_constants", "unknown", on_rig.two_constants),
        Case("soft_area", "unknown", on_rig.soft_area),
        Case("large_layer", "unknown", on_rig.large_layer),
        Case("upside_down", "unknown", on_rig.upside_down),
        Case("third_damping", "unknown", on_rig.third_of_damping),
        Case("softening_clamp", "unknown", on_rig.softening_clamp),
        Case("unstated_tank", "1170 in place of 998 kg/m3", on_rig.unstated_tank),
        Case("foundation", "named axial_load", on_rig.foundation),
        Case("heavy_sensor", "named lumped_mass, over 99.9 %", on_rig.heavy_sensor),
        Case("frame_stiffer", "0 of 8 right", storeys.storeys(1, 1.1, 1.4), each=4),
        Case("water", "1042 (1009 to 1082) in place of 998 kg/m3", in_water(Scene())),
        Case("water_hits", "1042 (1009 to 1082)", in_water(Scene(hits=True))),
        Case("water_no_wall", "", in_water(Scene(wall=False))),
        Case("water_even", "1058 (1034 to 1087)", in_water(Scene(even=True))),
        Case("water_tank", "", in_water(Scene(tank=True))),
        Case("water_stated", "", in_water(Scene(tank=True, stated=True))),
        Case("water_baseline", "", in_water(Scene(baseline=True))),
        Case("water_soft_clamp", "unknown", in_water(Scene(soft=True))),
        Case("water_soft_baseline", "", in_water(Scene(soft=True, baseline=True))),
        Case("water_oil", "unknown", in_water(Scene(oil=True))),
        Case("water_free", "", in_water(Scene(clamped=False))),
        Case("water_beam", "", in_water(Scene(kind="beam", aspect=(8.0, 14.0)))),
    )
}
"""First those of theory, likelihood and sets of causes, up to ``frame_softer``; then those of too narrow sketches."""
