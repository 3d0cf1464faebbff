"""Plots of live topics: `%plot /joint_commands/position[0]`, in rqt_plot's place."""
