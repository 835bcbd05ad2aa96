"""The bundled library: what it covers, and that it is what its builders say."""

import pytest
from PIL import Image

from kinetix.level.codec import level_hash, load_level, save_level
from kinetix.level.model import Solution
from kinetix.level.sets import level_files
from kinetix.paths import levels_dir
from scripts import difficulty
from scripts.build_levels import built, with_proof
from scripts.contact_sheet import GAP, LINE, sheet
from scripts.library.grades import Effort, graded, read_efforts

LEVELS = {
    f"{size}/{path.stem}": load_level(path)
    for size in ("s", "m", "l")
    for path in level_files(levels_dir() / size)
}
BUILT = dict(built())
TOPICS = [
    "arm",
    "balance",
    "bat",
    "beam",
    "carry",
    "cart-pole",
    "catapult",
    "chain",
    "cheetah",
    "crawler",
    "flight",
    "gears",
    "grasp",
    "hopper",
    "jump",
    "lander",
    "lever",
    "lorry",
    "maze",
    "pinball",
    "platforms",
    "rail",
    "ramp",
    "reach",
    "swimmer",
    "swing-up",
    "throw",
    "thruster",
    "tower",
    "trailer",
    "unicycle",
    "walker-2d",
    "wheels",
]


@pytest.mark.parametrize(("size", "least"), [("s", 12), ("m", 24), ("l", 36)])
def test_there_are_enough_levels_of_each_size(size, least):
    assert sum(name.startswith(f"{size}/") for name in LEVELS) >= least


@pytest.mark.parametrize("topic", TOPICS)
def test_every_topic_has_a_level(topic):
    assert any(topic in level.tags for level in LEVELS.values())


def test_the_readme_counts_right():
    readme = (levels_dir().parent / "README.md").read_text()
    assert f"{len(LEVELS)} levels of our own" in readme


def test_a_sheet_has_room_for_every_picture_and_its_name():
    pictures = [Image.new("RGB", (40, 40), colour) for colour in ("red", "green", "blue")]
    made = sheet(pictures, ["one", "two", "three"], 2)
    assert made.width == 2 * 40 + 3 * GAP
    assert made.height == 2 * (40 + LINE + GAP) + GAP
    middles = [made.getpixel((GAP + 20 + x * (40 + GAP), GAP + 20)) for x in range(2)]
    assert middles == [(255, 0, 0), (0, 128, 0)]
    assert sheet(pictures, [""] * 3, 3).height == 40 + 2 * GAP


def test_all_grades_of_difficulty_are_there_and_most_levels_are_easy():
    grades = [
        int(tag.removeprefix("difficulty-"))
        for level in LEVELS.values()
        for tag in level.tags
        if tag.startswith("difficulty-")
    ]
    assert set(grades) == {1, 2, 3, 4, 5}
    assert sum(grade <= 2 for grade in grades) > len(grades) / 2


@pytest.mark.parametrize(
    ("lucky", "passes", "difficulty"),
    [(256, 0, 1), (64, 0, 1), (63, 0, 2), (16, 0, 2), (4, 0, 3), (1, 0, 4), (0, 1, 4), (0, 2, 5)],
)
def test_difficulty_is_the_effort_that_was_measured(lucky, passes, difficulty):
    level = BUILT["s/plank_dash"].replace(tags=("wheels", "difficulty-3", "unicycle"))
    effort = Effort(level=level_hash(level), plans=256, lucky=lucky, passes=passes)
    assert graded(level, effort).tags == ("wheels", f"difficulty-{difficulty}", "unicycle")
    # What was measured on another level counts for nothing.
    assert graded(level.replace(max_timesteps=9), effort).tags == level.tags


def test_a_name_that_no_level_has_is_not_measured():
    with pytest.raises(SystemExit, match=r"no bundled level s/hang_onn.* did you mean 's/hang_on'"):
        difficulty.main(["s/hang_onn"])


def test_the_tags_say_what_was_measured():
    efforts = read_efforts()
    assert efforts.keys() <= LEVELS.keys()
    wrong = [name for name, level in LEVELS.items() if graded(level, efforts.get(name)) != level]
    assert wrong == [], "run `make levels`"


def test_no_two_levels_are_alike():
    assert len({level.name for level in LEVELS.values()}) == len(LEVELS)
    assert len({level_hash(level) for level in LEVELS.values()}) == len(LEVELS)


@pytest.mark.parametrize("name", LEVELS)
def test_a_level_has_a_solution_or_says_that_it_has_none(name):
    level = LEVELS[name]
    assert (level.solution is None) == ("unsolved" in level.tags)


@pytest.mark.parametrize("name", BUILT)
def test_a_file_is_what_its_builder_makes(name):
    assert LEVELS[name] == with_proof(BUILT[name], levels_dir() / f"{name}.json")


def test_a_changed_level_loses_its_solution(tmp_path):

    path = tmp_path / "level.json"
    level = BUILT["s/plank_dash"]
    solved = level.replace(
        solution=Solution(physics="balanced", frame_skip=2, actions=((3, (1, 0, 0, 0, 0, 0)),))
    )
    save_level(solved, path)
    assert with_proof(level, path).solution == solved.solution
    assert "unsolved" not in with_proof(level, path).tags
    changed = with_proof(level.replace(max_timesteps=9), path)
    assert changed.solution is None
    assert "unsolved" in changed.tags
