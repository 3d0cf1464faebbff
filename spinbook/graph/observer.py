"""Watches the node graph of ROS_DOMAIN_ID on behalf of another process: `python -m spinbook.graph.observer`.

Reads words from standard input, a line each, and ends with it:

    count    listen to topics that have a listener anyway, to know their rates, until the next word
    look     stop that, wait until the graph is known, and print it as one line of JSON
"""

from __future__ import annotations

import json
import queue
import sys
import threading

from spinbook.graph.sight import Sight
from spinbook.ros2.refusal import Refusal


def _listen(words: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        words.put(line.strip())
    words.put("end")


def observe(words: queue.SimpleQueue[str]) -> None:
    """Do what the words say, until "end"."""
    with Sight() as sight:
        while (word := words.get()) != "end":
            while word == "count" and words.empty():
                sight.count()
            sight.stop_counting()
            if word == "look":
                sight.come_to_rest()
                print(json.dumps(json.loads(sight.graph().to_json())), flush=True)


def main() -> None:
    """Observe until standard input ends."""
    words: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(words,), daemon=True).start()
    try:
        observe(words)
    except Refusal as error:
        sys.exit(error.format_message())


if __name__ == "__main__":
    main()
