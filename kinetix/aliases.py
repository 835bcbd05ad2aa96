"""Parameters that go by a second name."""

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def also_named(
    **second: str,
) -> Callable[[Callable[_Parameters, _Result]], Callable[_Parameters, _Result]]:
    """Return a decorator that lets parameters be given by a second name too.

    Args:
        **second: kinetix-env's name of each parameter and ours: `rng="key"`.
    """

    def decorate(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
        @functools.wraps(function)
        def called(*arguments: Any, **options: Any) -> _Result:
            for name in second.keys() & options.keys():
                if second[name] in options:
                    raise TypeError(f"{function.__name__}: {name} and {second[name]} are the same")
                options[second[name]] = options.pop(name)
            return function(*arguments, **options)

        return called

    return decorate
