"""Where the scenes of an RGB-D data set begin."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from placecue.checks import check_number
from placecue.errors import UsageError, choices
from placecue_sources.rgbd_frames import Frame

#: The labelled frames of NYU Depth v2 (Silberman et al., ECCV 2012), 0 to 1448, that are the first
#: of a scene, by the scene names that the data set gives with them. Its bookstore was recorded in
#: three parts by turns and counts as one. docs/nyu_scenes.md says how the list was checked.
# fmt: off
NYUV2 = (
    0, 2, 4, 8, 9, 13, 14, 18, 20, 21, 25, 27, 34, 38, 43, 45, 46, 47, 48, 49, 55, 57, 58, 63,
    66, 67, 72, 75, 79, 83, 119, 124, 129, 130, 134, 136, 137, 141, 145, 150, 151, 152, 154,
    155, 159, 163, 166, 168, 169, 170, 176, 179, 182, 188, 193, 202, 206, 207, 212, 216, 218,
    219, 220, 222, 238, 249, 250, 252, 254, 257, 259, 263, 264, 270, 271, 272, 273, 275, 278,
    279, 283, 285, 287, 289, 291, 295, 298, 300, 302, 305, 307, 309, 311, 312, 314, 317, 320,
    324, 328, 330, 332, 335, 338, 341, 343, 347, 350, 352, 354, 358, 362, 364, 367, 371, 376,
    379, 383, 386, 390, 394, 397, 402, 404, 407, 410, 414, 417, 420, 425, 429, 435, 440, 443,
    448, 451, 457, 461, 466, 468, 473, 477, 481, 484, 486, 489, 496, 498, 499, 502, 505, 507,
    510, 513, 514, 519, 522, 526, 530, 533, 536, 539, 543, 548, 551, 554, 558, 560, 564, 568,
    571, 574, 578, 583, 587, 590, 594, 596, 602, 607, 608, 611, 613, 616, 621, 623, 627, 629,
    632, 638, 643, 645, 647, 649, 650, 651, 653, 655, 658, 660, 662, 664, 667, 670, 673, 675,
    677, 679, 681, 683, 685, 687, 690, 692, 694, 696, 699, 701, 704, 705, 708, 710, 713, 716,
    718, 721, 723, 726, 728, 730, 732, 734, 736, 738, 739, 742, 744, 758, 761, 766, 771, 776,
    779, 782, 787, 794, 799, 804, 809, 814, 820, 823, 829, 832, 836, 842, 846, 849, 852, 856,
    862, 868, 871, 875, 879, 883, 887, 894, 899, 905, 908, 912, 916, 919, 922, 925, 928, 931,
    935, 937, 940, 942, 944, 947, 949, 951, 954, 957, 958, 960, 962, 964, 967, 969, 974, 977,
    980, 985, 988, 990, 993, 995, 997, 1000, 1004, 1007, 1009, 1012, 1017, 1020, 1023, 1026,
    1028, 1031, 1034, 1037, 1039, 1043, 1047, 1049, 1051, 1053, 1056, 1058, 1061, 1065, 1069,
    1072, 1074, 1076, 1080, 1084, 1087, 1090, 1093, 1096, 1097, 1099, 1102, 1104, 1105, 1109,
    1112, 1114, 1116, 1119, 1122, 1126, 1128, 1131, 1134, 1136, 1140, 1143, 1146, 1149, 1152,
    1155, 1158, 1161, 1164, 1167, 1169, 1171, 1173, 1176, 1178, 1180, 1182, 1184, 1186, 1189,
    1191, 1194, 1196, 1198, 1200, 1203, 1205, 1208, 1212, 1215, 1217, 1220, 1223, 1225, 1230,
    1232, 1235, 1237, 1240, 1243, 1246, 1250, 1253, 1257, 1261, 1265, 1270, 1274, 1276, 1280,
    1284, 1288, 1290, 1293, 1295, 1296, 1297, 1299, 1301, 1305, 1307, 1308, 1311, 1313, 1314,
    1315, 1316, 1319, 1323, 1326, 1328, 1329, 1331, 1332, 1334, 1337, 1340, 1345, 1346, 1349,
    1352, 1354, 1356, 1360, 1363, 1365, 1367, 1369, 1371, 1375, 1377, 1381, 1383, 1386, 1391,
    1393, 1396, 1399, 1401, 1403, 1406, 1411, 1414, 1416, 1420, 1424, 1429, 1433, 1436, 1440,
    1443,
)
# fmt: on
SHIPPED: dict[str, Sequence[float]] = {"nyuv2": NYUV2}


def cut_into_scenes(frames: Sequence[Frame], cuts: Sequence[float] | str) -> list[Frame]:
    """Return frames with the scene of each: the number of the last cut before it, from 1.

    Parameters
    ----------
    frames : sequence of Frame
        In order of time.
    cuts : sequence of float, or str
        The times at which scenes begin, s, increasing; or the name of a list that is shipped.
        What comes before the first is scene 0.

    Raises
    ------
    UsageError
        If there is no list of that name, or a cut is no number or not after the one before.
    """
    nanoseconds = [round(cut * 1e9) for cut in _times(cuts)]
    return [replace(each, scene=str(bisect_right(nanoseconds, each.stamp))) for each in frames]


def _times(cuts: Sequence[float] | str) -> Sequence[float]:
    if isinstance(cuts, str):
        if cuts not in SHIPPED:
            raise UsageError(f"cuts has no list '{cuts}'; {choices(cuts, SHIPPED)}")
        return SHIPPED[cuts]
    for cut in cuts:
        check_number("cuts", cut, least=0)
    for before, after in pairwise(cuts):
        if after <= before:
            raise UsageError(f"cuts has {after:g} s after {before:g} s: give them in order")
    return cuts
