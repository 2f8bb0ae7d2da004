import numpy as np

from placecue import Cue


class Spread(Cue):
    requires = ("scan",)

    def __init__(self, power=1.0):
        self.power = power

    def extract(self, observation):
        ranges = observation.scan.filled() ** self.power
        return np.array([ranges.mean(), ranges.std()])


class Nearest(Cue):
    requires = ("scan",)

    def __init__(self, count=3):
        self.count = count

    def extract(self, observation):
        return np.sort(observation.scan.filled())[: self.count]
