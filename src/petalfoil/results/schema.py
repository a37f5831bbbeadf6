"""Every variable a result may hold, with its dimensions, SI unit, long name and symbol.

The tables below are the one place where a name is declared: a record refuses any other, and the NetCDF file takes its
attributes from here.
"""

from __future__ import annotations

from collections.abc import Mapping

from petalfoil.results.variable import DataType, Role, Variable


def _given(units: str, long_name: str, symbol: str) -> Variable:
    return Variable((), units, long_name, symbol, role=Role.GIVEN)


def _answer(units: str, long_name: str, symbol: str, kind: DataType = DataType.FLOAT) -> Variable:
    return Variable((), units, long_name, symbol, kind)


def _run(units: str, long_name: str, symbol: str, kind: DataType = DataType.FLOAT) -> Variable:
    return Variable((), units, long_name, symbol, kind, Role.BOOKKEEPING)


def _geometry(units: str, long_name: str, symbol: str, kind: DataType = DataType.FLOAT) -> Variable:
    return Variable((), units, long_name, symbol, kind, Role.GEOMETRY)


_FILM = ("petal", "phi_exposed", "z")
_PETAL = ("petal", "phi", "z")
_TIME = ("time",)
_CONTACT = ("contact",)

COORDINATES: dict[str, Variable] = {
    "petal": Variable(
        ("petal",), "1", "petal number, growing with the bushing angle", "l", DataType.INT, Role.GEOMETRY
    ),
    "root_angle": Variable(("petal",), "rad", "bushing angle of the petal's root", "theta_l", role=Role.GEOMETRY),
    "phi": Variable(("phi",), "rad", "angle from the petal's root", "phi", role=Role.GEOMETRY),
    "phi_exposed": Variable(
        ("phi_exposed",),
        "rad",
        "angle from the petal's root, on the strip exposed to the film",
        "phi",
        role=Role.GEOMETRY,
    ),
    "whirl_frequency": Variable(("whirl_frequency",), "rad s-1", "whirl frequency", "Omega", role=Role.GEOMETRY),
    "row": Variable(("row",), "1", "direction of the force: 0 along x, 1 along y", "i", DataType.INT, Role.GEOMETRY),
    "column": Variable(
        ("column",), "1", "direction of the displacement: 0 along x, 1 along y", "j", DataType.INT, Role.GEOMETRY
    ),
    "load_orientation": Variable(
        ("load_orientation",), "rad", "direction of the load, from x toward y", "psi", role=Role.GEOMETRY
    ),
    "mode": Variable(("mode",), "1", "number of the natural mode, by frequency", "k", DataType.INT, Role.GEOMETRY),
    "load": Variable(("load",), "N", "size of the load on the journal", "|load|", role=Role.GEOMETRY),
    "contact": Variable(_CONTACT, "1", "number of a contact between nodes", "c", DataType.INT, Role.GEOMETRY),
    "z": Variable(("z",), "m", "distance along the bearing axis", "z", role=Role.GEOMETRY),
    "time": Variable(_TIME, "s", "time", "t", role=Role.GEOMETRY),
    "frame": Variable(("frame",), "s", "time of a picture of film and petals", "t", role=Role.GEOMETRY),
    "unknown": Variable(("unknown",), "1", "number of an unknown of film and petals", "i", DataType.INT, Role.GEOMETRY),
    "gap": Variable(
        ("gap",), "1", "number of a gap between journal, petals and bushing", "j", DataType.INT, Role.GEOMETRY
    ),
    "petal_unknown": Variable(
        ("petal_unknown",),
        "1",
        "number of an unknown of petals with continuous slopes",
        "k",
        DataType.INT,
        Role.GEOMETRY,
    ),
    "point_number": Variable(
        ("point_number",), "1", "number in the list of contact points", "q", DataType.INT, Role.GEOMETRY
    ),
    "line_number": Variable(
        ("line_number",), "1", "number in the list of contact lines", "q", DataType.INT, Role.GEOMETRY
    ),
    "slide": Variable(("slide",), "1", "number of a place where petals slide", "i", DataType.INT, Role.GEOMETRY),
    "axis": Variable(("axis",), "1", "direction: 0 along x, 1 along y", "i", DataType.INT, Role.GEOMETRY),
}

FIELDS: dict[str, Variable] = {
    "pressure": Variable(_FILM, "Pa", "absolute pressure of the film", "p"),
    "film_thickness": Variable(_FILM, "m", "film thickness between journal and petal", "h"),
    "journal_contact_pressure": Variable(_FILM, "Pa", "contact pressure between journal and petal", "lambda_J"),
    "deflection": Variable(_PETAL, "m", "deflection of the petal, positive toward the bushing", "W"),
    "radius": Variable(_PETAL, "m", "radius of the deformed mid-surface of the petal", "r"),
    "free_radius": Variable(("phi",), "m", "radius of the free mid-surface of a petal", "r_0", role=Role.GEOMETRY),
    "backing_deflection": Variable(_PETAL, "m", "deflection of the backing springs behind the petals", "V"),
    "bushing_contact_pressure": Variable(_PETAL, "Pa", "contact pressure between petal and bushing", "lambda_B"),
    "petal_contact_pressure": Variable(
        _PETAL, "Pa", "contact pressure between petal l and petal l+1, at the angle of petal l", "lambda_P"
    ),
    "contact_petal": Variable(_CONTACT, "1", "petal that touches there", "l_c"),
    "contact_facing": Variable(_CONTACT, "1", "what it touches: 0 the journal, 1 the bushing, 2 petal l+1", "f_c"),
    "contact_angle": Variable(_CONTACT, "rad", "angle of the contact from the petal's root", "phi_c"),
    "contact_force": Variable(_CONTACT, "N", "normal force of the contact over the whole length", "Lambda_c"),
    "contact_bending_stress": Variable(
        _CONTACT, "Pa", "bending stress at the contact, of the two petals the larger one", "sigma_c"
    ),
    "stiffness": Variable(("whirl_frequency", "row", "column"), "N m-1", "stiffness of the bearing", "K"),
    "damping": Variable(("whirl_frequency", "row", "column"), "N s m-1", "damping of the bearing", "C"),
    "natural_frequency": Variable(("mode",), "rad s-1", "damped natural frequency of the rotor", "omega_d"),
    "natural_frequency_error": Variable(("mode",), "rad s-1", "error bar of the natural frequency", "d omega_d"),
    "mode_growth_rate_error": Variable(("mode",), "s-1", "error bar of the growth rate of the mode", "d Re s_k"),
    "damping_ratio_error": Variable(("mode",), "1", "error bar of the damping ratio", "d zeta"),
    "natural_frequency_harmonics_change": Variable(
        ("mode",), "rad s-1", "change of the natural frequency from half as many harmonics", "d omega_dh"
    ),
    "mode_growth_rate_harmonics_change": Variable(
        ("mode",), "s-1", "change of the growth rate of the mode from half as many harmonics", "d Re s_kh"
    ),
    "damping_ratio_harmonics_change": Variable(
        ("mode",), "1", "change of the damping ratio from half as many harmonics", "d zeta_h"
    ),
    "mode_growth_rate": Variable(("mode",), "s-1", "growth rate of the mode, negative where it dies out", "Re s_k"),
    "damping_ratio": Variable(("mode",), "1", "damping ratio of the mode, negative where it grows", "zeta"),
    "participation": Variable(("mode",), "1", "part of the rotor's mass in the mode", "q"),
    "whirl_direction": Variable(("mode",), "1", "1 for forward, -1 for backward whirl, 0 along a line", "kappa"),
    "mode_tilt": Variable(("mode",), "1", "part of the tilt in the motion of the journals, by its square", "t"),
    "mode_friction_harmonics": Variable(
        ("mode",), "1", "odd harmonics of the slips of petals that rub in a mode", "N_hk"
    ),
    "bending_stress": Variable(
        _PETAL, "Pa", "bending stress of the petal's metal along phi, assembly included", "sigma_phi"
    ),
    "membrane_stress": Variable(
        _PETAL, "Pa", "mean stress over the petal's metal along phi, where petals stretch", "sigma_m"
    ),
}

HISTORIES: dict[str, Variable] = {
    "x": Variable(_TIME, "m", "displacement of the journal's centre along x", "e_x"),
    "y": Variable(_TIME, "m", "displacement of the journal's centre along y", "e_y"),
    "velocity_x": Variable(_TIME, "m s-1", "velocity of the journal's centre along x", "v_x"),
    "velocity_y": Variable(_TIME, "m s-1", "velocity of the journal's centre along y", "v_y"),
    "slope_x": Variable(_TIME, "rad", "slope of the shaft's axis along x", "a_x"),
    "slope_y": Variable(_TIME, "rad", "slope of the shaft's axis along y", "a_y"),
    "slope_rate_x": Variable(_TIME, "rad s-1", "rate of the slope of the shaft's axis along x", "a_x'"),
    "slope_rate_y": Variable(_TIME, "rad s-1", "rate of the slope of the shaft's axis along y", "a_y'"),
    "shaft_speed": Variable(_TIME, "rad s-1", "angular velocity of the shaft", "omega"),
    "shaft_angle": Variable(_TIME, "rad", "angle that the shaft has turned", "theta_s"),
    "min_film_thickness": Variable(_TIME, "m", "minimum film thickness", "min h"),
    "contact_fraction": Variable(
        _TIME,
        "1",
        "contact normal force over contact normal force plus integral of the film's pressure above ambient",
        "s_c",
    ),
    "peak_pressure": Variable(_TIME, "Pa", "peak absolute pressure of the film", "p_max"),
    "force_x": Variable(_TIME, "N", "force of film and contact on the journal along x", "F_x"),
    "force_y": Variable(_TIME, "N", "force of film and contact on the journal along y", "F_y"),
    "friction_torque": Variable(_TIME, "N m", "friction torque on the journal, film and contact", "M"),
    "kinetic_energy": Variable(_TIME, "J", "energy of the rotor's motion across the bearing", "T"),
    "elastic_energy": Variable(_TIME, "J", "elastic energy of the petals above the start's", "U"),
    "load_work": Variable(_TIME, "J", "work of load, rotating load and unbalance on the rotor", "W_load"),
    "film_work": Variable(_TIME, "J", "work of the film on rotor and petals", "W_film"),
    "shaft_work": Variable(_TIME, "J", "work of the shaft against film and dry friction", "W_shaft"),
    "rubbing_work": Variable(_TIME, "J", "work of the shaft against dry friction alone", "W_rub"),
    "petal_friction_work": Variable(
        _TIME, "J", "energy lost where petals slide on each other and the bushing, or by the loss of a foil", "W_p"
    ),
    "frame_pressure": Variable(("frame", *_FILM), "Pa", "absolute pressure of the film", "p"),
    "frame_film_thickness": Variable(("frame", *_FILM), "m", "film thickness between journal and petal", "h"),
    "frame_radius": Variable(("frame", *_PETAL), "m", "radius of the deformed mid-surface of the petal", "r"),
    "frame_x": Variable(("frame",), "m", "displacement of the journal's centre along x", "e_x"),
    "frame_y": Variable(("frame",), "m", "displacement of the journal's centre along y", "e_y"),
    "last_state": Variable(
        ("unknown",), "1", "deflections and pressures at the end, in the units of the coupled system", "X"
    ),
    "last_reactions": Variable(
        ("gap",), "1", "contact reactions at the end, in the units of the coupled system", "lambda"
    ),
    "last_friction": Variable(
        ("slide",), "1", "friction of the petals at the end, in the units of the coupled system", "T"
    ),
    "last_petals": Variable(
        ("petal_unknown",), "1", "values and slopes of petals at the end, in the units of the coupled system", "w"
    ),
    "last_points": Variable(
        ("point_number",),
        "1",
        "contact points at the end: how many travel, curves, positions, points in stretches, reactions",
        "t",
    ),
    "last_lines": Variable(
        ("line_number",),
        "1",
        "contact lines at the end: how many points, their kinds, lines, angles and reactions, then nodes and theirs",
        "t",
    ),
    "last_position": Variable(("axis",), "m", "displacement of the journal's centre at the end", "e"),
    "last_velocity": Variable(("axis",), "m s-1", "velocity of the journal's centre at the end", "v"),
}
"""What a motion leaves behind: over time, as pictures, and the state at its end, from which it can go on."""

FIELDS |= HISTORIES

SCALARS: dict[str, Variable] = {
    "speed": _given("rad s-1", "angular velocity of the journal", "omega"),
    "eccentricity_x": _given("m", "displacement of the journal's centre along x", "e_x"),
    "eccentricity_y": _given("m", "displacement of the journal's centre along y", "e_y"),
    "tilt_x": _given("rad", "slope of the journal's axis along x", "a_x"),
    "tilt_y": _given("rad", "slope of the journal's axis along y", "a_y"),
    "load_moment_x": _given("N m", "moment of the load about the bearing's centre, toward x", "moment_x"),
    "load_moment_y": _given("N m", "moment of the load about the bearing's centre, toward y", "moment_y"),
    "shaft_growth": _given("m", "growth of the journal's radius by speed and temperature", "u_s"),
    "bushing_growth": _given("m", "growth of the bushing's radius by temperature", "u_b"),
    "load_x": _given("N", "load on the journal along x", "load_x"),
    "load_y": _given("N", "load on the journal along y", "load_y"),
    "leg": Variable(
        (), "", "part of the way: up or down, loading, unloading or reloading", "leg", DataType.STR, Role.GIVEN
    ),
    "contact_fraction_limit": _given("1", "contact fraction at lift-off and touchdown", "s_c*"),
    "whirl_amplitude": _given("m", "amplitude of the whirl at which petals rub", "a"),
    "friction_harmonics": _run("1", "odd harmonics of the slips of petals that rub", "N_h", DataType.INT),
    "friction_harmonics_change": _run(
        "1", "change of the friction on the journal from half as many harmonics, over it", "dT_h"
    ),
    "critical_mass_harmonics_change": _run("kg", "change of the critical mass from half as many harmonics", "dm_h"),
    "whirl_ratio_harmonics_change": _run("1", "change of the whirl ratio from half as many harmonics", "dgamma_h"),
    "rotor_mass": _given("kg", "mass of a rigid rotor; in two bearings all of it", "m"),
    "force_x": _answer("N", "force of film and contact on the journal along x", "F_x"),
    "force_y": _answer("N", "force of film and contact on the journal along y", "F_y"),
    "moment_x": _answer("N m", "moment of film and contact on the journal about the bearing's centre, toward x", "M_x"),
    "moment_y": _answer("N m", "moment of film and contact on the journal about the bearing's centre, toward y", "M_y"),
    "bearing_force": _answer("N", "magnitude of the force on the journal", "|F|"),
    "attitude_angle": _answer(
        "rad", "angle from the carried load to the displacement, positive with the rotation", "beta"
    ),
    "film_force_x": _answer("N", "force of the film on the journal along x", "F_film,x"),
    "film_force_y": _answer("N", "force of the film on the journal along y", "F_film,y"),
    "contact_force_x": _answer("N", "force of the contacts on the journal along x", "F_contact,x"),
    "contact_force_y": _answer("N", "force of the contacts on the journal along y", "F_contact,y"),
    "contact_normal_force": _answer("N", "sum of the normal forces of contact on the journal", "sum lambda_J"),
    "contact_fraction": _answer(
        "1", "contact normal force over contact normal force plus integral of the film's pressure above ambient", "s_c"
    ),
    "min_film_thickness": _answer("m", "minimum film thickness", "min h"),
    "min_film_thickness_angle": _answer("rad", "bushing angle of the minimum film thickness", "theta(min h)"),
    "min_film_thickness_z": _answer("m", "axial place of the minimum film thickness", "z(min h)"),
    "knudsen_number": _answer("1", "mean free path at ambient pressure over the minimum film thickness", "Kn"),
    "peak_pressure": _answer("Pa", "peak absolute pressure of the film", "p_max"),
    "peak_pressure_angle": _answer("rad", "bushing angle of the peak pressure", "theta(p_max)"),
    "petal_friction_work": _answer(
        "J", "energy lost where petals slide on each other and the bushing, or by the loss of a foil", "W_p"
    ),
    "friction_torque": _answer("N m", "friction torque on the journal, film and contact", "M"),
    "starting_torque": _answer("N m", "torque of dry friction at rest", "M_0"),
    "power_loss": _answer("W", "friction torque times angular velocity", "M omega"),
    "film_temperature": _answer("K", "mean temperature of the gas in the film", "T_f"),
    "shaft_temperature": _answer("K", "temperature of the shaft", "T_s"),
    "pack_temperature": _answer("K", "temperature of the petal pack, or of the bore's surface", "T_p"),
    "bushing_temperature": _answer("K", "temperature of the bushing", "T_b"),
    "heat_to_shaft": _answer("W", "heat that film and contact pass to the shaft", "Q_s"),
    "heat_to_pack": _answer("W", "heat that film and contact pass to the pack", "Q_p"),
    "heat_to_gas": _answer("W", "heat that the side leakage carries away", "Q_g"),
    "heat_balance_error": _answer("1", "friction power less the heat that leaves the film, over the power", "e_q"),
    "side_leakage": _answer("kg s-1", "mass flow of gas that leaves at both ends", "m_dot"),
    "max_backing_deflection": _answer("m", "largest deflection of the backing springs", "max V"),
    "max_deflection": _answer("m", "largest deflection of a bump foil", "max W"),
    "max_membrane_stress": _answer("Pa", "maximum magnitude of the membrane stress of the petals", "max sigma_m"),
    "max_bending_stress": _answer("Pa", "maximum magnitude of the bending stress of the petals", "sigma_max"),
    "shaft_slope_x": _answer("rad", "slope of the shaft in two bearings along x", "a_x"),
    "shaft_slope_y": _answer("rad", "slope of the shaft in two bearings along y", "a_y"),
    "other_eccentricity_x": _answer("m", "displacement of the journal in the other bearing along x", "e_x,2"),
    "other_eccentricity_y": _answer("m", "displacement of the journal in the other bearing along y", "e_y,2"),
    "other_force_x": _answer("N", "force of the other bearing on the shaft along x", "F_x,2"),
    "other_force_y": _answer("N", "force of the other bearing on the shaft along y", "F_y,2"),
    "other_contact_fraction": _answer("1", "contact fraction of the other bearing", "s_c,2"),
    "other_min_film_thickness": _answer("m", "minimum film thickness of the other bearing", "min h_2"),
    "other_peak_pressure": _answer("Pa", "peak absolute pressure of the other bearing", "p_max,2"),
    "other_power_loss": _answer("W", "power loss of the other bearing", "M_2 omega"),
    "other_film_temperature": _answer("K", "temperature of the film of the other bearing", "T_f,2"),
    "other_bushing_temperature": _answer("K", "temperature of the bushing of the other bearing", "T_b,2"),
    "other_shaft_temperature": _answer("K", "temperature of the shaft in the other bearing", "T_s,2"),
    "other_pack_temperature": _answer("K", "temperature of the pack of the other bearing", "T_p,2"),
    "verdict": _run("", "whether the rotor is stable", "verdict", DataType.STR),
    "mass_margin": _answer("1", "critical mass over the mass of the rotor: unstable below 1", "m_c/m"),
    "critical_mass": _answer("kg", "critical mass of a rigid rotor: it whirls above", "m_c"),
    "whirl_ratio": _answer("1", "whirl frequency over speed at the critical mass", "gamma"),
    "threshold_speed": _answer("rad s-1", "speed at which the rotor becomes unstable", "omega_c"),
    "liftoff_speed": _answer("rad s-1", "lift-off speed, ascending", "omega_up"),
    "touchdown_speed": _answer("rad s-1", "touchdown speed, descending", "omega_down"),
    "liftoff_by_contact_film_thickness": _answer(
        "1", "logarithmic derivative of the lift-off speed by the contact film thickness", "d ln omega_up/d ln h_c"
    ),
    "liftoff_by_contact_fraction": _answer(
        "1", "logarithmic derivative of the lift-off speed by the contact fraction", "d ln omega_up/d ln s_c*"
    ),
    "stable": _answer("", "the equilibrium of film and petals is stable at the fixed journal", "stable", DataType.BOOL),
    "growth_rate": _answer(
        "s-1", "real part of the leading eigenvalue of film and petals at the fixed journal", "Re s"
    ),
    "growth_frequency": _answer(
        "rad s-1", "imaginary part of the leading eigenvalue of film and petals at the fixed journal", "Im s"
    ),
    "energy_balance_error": _answer(
        "1", "energy of rotor and petals beyond the work done on them, over the work exchanged", "d_energy"
    ),
    "contact_model_energy": _answer(
        "1", "energy of the steps of a motion between contact points and nodes, over the work exchanged", "d_model"
    ),
    "amplitude": _answer(
        "m", "largest distance of a journal from its mean position, in the last half of a motion", "A"
    ),
    "tilt_amplitude": _answer("rad", "largest slope of the shaft from its mean, in the last half of a motion", "A_t"),
    "tilt_whirl_ratio": _answer("1", "dominant frequency of the shaft's slope over the speed", "nu_t"),
    "dominant_whirl_ratio": _answer(
        "1", "frequency of the largest circle of the whirl over the speed, negative for backward whirl", "Omega/omega"
    ),
    "revolutions": _answer("1", "revolutions of the shaft", "N_rev"),
    "steps": _run("1", "steps in time", "N_steps", DataType.INT),
    "rejected_steps": _run("1", "steps taken again shorter, for their error", "N_refused", DataType.INT),
    "failed_steps": _run("1", "steps taken again shorter, for want of an answer", "N_failed", DataType.INT),
    "tolerance": _given("1", "local error of a step in reference films and ambient pressures", "tol"),
    "residual": _run("1", "largest scaled residual of the coupled system", "res"),
    "force_residual": _run("1", "force left over by film, contacts and load, over the load", "d_load"),
    "carried_by": _run("", "what carries the load", "carried by", DataType.STR),
    "mass_balance_error": _run("1", "relative error of the mass balance of the film", "d_mass"),
    "reaction_balance_error": _run(
        "1", "relative error of the balance of loads and reactions of the petals", "d_force"
    ),
    "iterations": _run("1", "iterations of the coupled system", "N_it", DataType.INT),
    "factorizations": _run("1", "factorisations of the coupled system", "N_lu", DataType.INT),
    "pack_iterations": _run("1", "iterations of the foil pack alone", "N_pk", DataType.INT),
    "probe_factorizations": _run("1", "factorisations for stability and other equilibria", "N_probe", DataType.INT),
    "coarse_factorizations": _run("1", "factorisations on coarser grids that lead here", "N_coarse", DataType.INT),
    "cells_per_pitch": _run("1", "cells per pitch; of a plain bearing, round the circle", "N", DataType.INT),
    "axial_cells": _run("1", "cells over the whole length", "N_z", DataType.INT),
    "reference_film_thickness": _run("m", "film thickness the film equation is scaled with", "h_ref"),
    "wall_time": _run("s", "time spent", "t_wall"),
    "converged": _run("", "the state satisfies the equations to tolerance", "converged", DataType.BOOL),
    "status": _run("", "how the run ended", "status", DataType.STR),
    "solution_path": _run("", "how the equilibrium was reached", "solution_path", DataType.STR),
    "nodal_force_difference": _run(
        "1", "difference of the force from that with contacts at nodes, over that force", "dF_n"
    ),
    "friction_path": _run("", "path that friction forces between petals are those of", "friction_path", DataType.STR),
    "bottomed_out": _run("", "journal, petals and bushing touch at one angle", "bottomed_out", DataType.BOOL),
    "contact_model": _run("", "where contacts are", "contact_model", DataType.STR),
    "point_share": _run("1", "share of the steps of a motion or a path with contact points between nodes", "share_pts"),
    "known_equilibria": _run("1", "equilibria known at this position", "N_eq", DataType.INT),
    "jump": _run("", "this point left the branch of the point before", "jump", DataType.BOOL),
    "journal_radius": _geometry("m", "radius of the journal", "R_j"),
    "bushing_radius": _geometry("m", "radius of the bushing", "R_B"),
    "length": _geometry("m", "length of the bearing", "L"),
    "backing_height": _geometry("m", "height of the free crowns of backing springs", "h_s"),
    "backing_start": _geometry("m", "arc length from a root to its backing springs", "l_s"),
    "span": _geometry("m", "distance between two bearings", "2 l"),
    "rotor_centre": _geometry("m", "mass centre of the rotor, from the middle of its bearings", "z_G"),
    "petal_thickness": _geometry("m", "thickness of a petal with its coating", "delta"),
    "ambient_pressure": _geometry("Pa", "ambient pressure, absolute", "p_a"),
    "contact_film_thickness": _geometry("m", "contact film thickness, at which the journal touches", "h_min"),
    "overlap": _geometry("1", "petal angle over pitch", "phi_1/phi_0"),
    "layers": _geometry("1", "largest number of petals at one angle", "N_layers", DataType.INT),
    "petal_angle": _geometry("rad", "angle a petal spans", "phi_1"),
    "pitch": _geometry("rad", "angle between neighbouring roots", "phi_0"),
    "covered_angle": _geometry("rad", "angle over which a petal is covered by the one before", "phi_3"),
    "metric_radius": _geometry("m", "radius of the mid-surface of a petal on the bore", "r_m"),
    "radial_clearance": _geometry("m", "radial clearance where it is narrowest", "c"),
    "pack_clearance": _geometry(
        "m", "radial clearance above the solid pack height and the contact film thickness", "c_left"
    ),
    "compressibility_number": _geometry("1", "compressibility number on the radial clearance", "Lambda"),
    "viscosity": _geometry("Pa s", "dynamic viscosity of the gas", "mu"),
    "contact_knudsen_number": _geometry(
        "1", "mean free path at ambient pressure over the contact film thickness", "Kn_c"
    ),
    "clearance_knudsen_number": _geometry("1", "mean free path at ambient pressure over the radial clearance", "Kn_C"),
    "mean_free_path": _geometry("m", "mean free path of the gas at ambient pressure", "lambda_a"),
    "foundation_stiffness": _geometry("Pa m-1", "pressure over deflection of a bump foil or of backing springs", "k_b"),
    "bending_stiffness": _geometry("N m", "bending stiffness of a petal per length", "D"),
    "root_tilt": _geometry("rad", "turn of the free petal at its root, inward from the bore's tangent", "psi"),
    "first_contact_angle": _geometry(
        "rad", "angle from the root at which a free petal would first meet the journal", "phi_c"
    ),
    "free_petal_height": _geometry("m", "largest stand-off of a free petal from the bore", "max(r_m - r_0)"),
}

VARIABLES: dict[str, Variable] = {**COORDINATES, **FIELDS, **SCALARS}


def declare(results: Mapping[str, Variable]) -> None:
    """Add the results that an analysis declares for itself; the same declaration twice is one.

    Raises
    ------
    ValueError
        A name is already declared differently.
    """
    for name, variable in results.items():
        if VARIABLES.setdefault(name, variable) != variable:
            raise ValueError(f"the result {name!r} is already declared as {VARIABLES[name]}")
        (FIELDS if variable.dims else SCALARS)[name] = variable
