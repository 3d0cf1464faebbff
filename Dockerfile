# The course in JupyterLab, for Windows, macOS and any machine with Docker:
#
#   docker build -t spinbook . && docker run -it --rm -p 127.0.0.1:8888:8888 spinbook
#
# On x86-64 ROS 2 comes from PyPI, on a small Python image. PyPI has no ROS 2 for ARM (Apple's M chips, Raspberry Pi):
# there the base is ROS's own image, and its ROS 2 is used. Docker sets TARGETARCH to what it builds for; to choose:
#
#   docker build --platform linux/arm64 -t spinbook .
#   docker build --build-arg BASE=arm64 -t spinbook .      # ROS's own image, on x86-64 too
ARG BASE=${TARGETARCH:-amd64}

FROM python:3.12-slim-bookworm AS base-amd64
RUN apt-get update \
    && apt-get install -y --no-install-recommends bubblewrap g++ git make procps \
    && rm -rf /var/lib/apt/lists/*

FROM ros:jazzy-ros-base-noble AS base-arm64
RUN apt-get update \
    && apt-get install -y --no-install-recommends bubblewrap g++ git make procps python3-venv \
       ros-jazzy-example-interfaces ros-jazzy-test-msgs ros-jazzy-turtlesim \
    && rm -rf /var/lib/apt/lists/* \
    && if id ubuntu >/dev/null 2>&1; then userdel --remove ubuntu; fi

FROM base-${BASE}
COPY --chmod=755 container/with-ros.sh /usr/local/bin/with-ros
RUN useradd --create-home --uid 1000 --shell /bin/bash student \
    && echo '[ ! -f /opt/ros/jazzy/setup.bash ] || . /opt/ros/jazzy/setup.bash' >>/home/student/.bashrc \
    && install -d -o student -g student /course
USER student
WORKDIR /course
# The environment is not in the checkout, so that a checkout of one's own can be mounted on /course.
ENV VENV=/home/student/venv PATH=/home/student/venv/bin:$PATH PIP_NO_CACHE_DIR=1
COPY --chown=student:student . .
RUN with-ros make setup && with-ros spinbook build
EXPOSE 8888
ENTRYPOINT ["with-ros"]
CMD ["container/start.sh"]
