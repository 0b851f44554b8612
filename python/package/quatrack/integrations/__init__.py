"""The controller and the plant where other people's simulators and tools expect one.

Each module imports its own package and nothing imports these modules:

    rotorpy             a controller for RotorPy's Environment
    crazyflow           rotor commands for crazyflow's Sim, vectorised
    drone_models        rotor commands for the models of drone-models, vectorised
    gym_pybullet_drones rotor commands for gym-pybullet-drones' CtrlAviary, for all of its drones
    gymnasium           a vector environment of our plant
    control             state space systems of python-control in, gains out, and back
    crazyswarm2         a controller back end for crazyswarm2's simulator
"""
