#!/bin/sh
# Runs a command with the image's ROS 2, where the image has one of its own.
set -e
if [ -f /opt/ros/jazzy/setup.sh ]; then . /opt/ros/jazzy/setup.sh; fi
exec "$@"
