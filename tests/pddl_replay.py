"""A small interpreter of PDDL that shares nothing with the reader: it runs a plan by the actions of the domain file."""

import itertools
import re


class ReplayError(AssertionError):
    """A plan that the domain file does not allow."""


def parse(text):
    tokens = re.findall(r"[()]|[^\s()]+", re.sub(r";.*", "", text).lower())
    stack = [[]]
    for token in tokens:
        if token == "(":
            stack.append([])
        elif token == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    return stack[0][0]


def typed(listed):
    """Pairs of a name and its types, of a typed list."""
    pairs, waiting, rest = [], [], list(listed)
    while rest:
        entry = rest.pop(0)
        if entry != "-":
            waiting.append(entry)
            continue
        types = rest.pop(0)
        pairs += [(name, types[1:] if isinstance(types, list) else [types]) for name in waiting]
        waiting = []
    return pairs + [(name, ["object"]) for name in waiting]


class World:
    """The state of a problem under its domain."""

    def __init__(self, domain, problem):
        domain, problem = parse(domain), parse(problem)
        sections = {section[0]: section[1:] for section in domain[2:] + problem[2:] if section[0] != ":action"}
        self.parents = dict(typed(sections.get(":types", [])))
        self.objects = dict(typed(sections.get(":constants", [])) + typed(sections.get(":objects", [])))
        self.actions = {s[1]: dict(zip(s[2::2], s[3::2], strict=True)) for s in domain[2:] if s[0] == ":action"}
        self.rules = {s[1][0]: ([n for n, _ in typed(s[1][1:])], s[2]) for s in domain[2:] if s[0] == ":derived"}
        self.facts = {tuple(fact) for fact in sections[":init"] if fact[0] not in ("=", "not")}
        self.goal = sections[":goal"][0]

    def fits(self, name, types):
        own, found = list(self.objects[name]), {"object"}
        while own:
            one = own.pop()
            found.add(one)
            own += self.parents.get(one, [])
        return not found.isdisjoint(types)

    def bindings(self, variables, bound):
        named = typed(variables)
        things = [[name for name in self.objects if self.fits(name, types)] for _, types in named]
        for chosen in itertools.product(*things):
            yield {**bound, **dict(zip([name for name, _ in named], chosen, strict=True))}

    def holds(self, part, bound):
        if not part:
            return True
        head, *rest = part
        match head:
            case "and":
                return all(self.holds(one, bound) for one in rest)
            case "or":
                return any(self.holds(one, bound) for one in rest)
            case "not":
                return not self.holds(rest[0], bound)
            case "imply":
                return not self.holds(rest[0], bound) or self.holds(rest[1], bound)
            case "forall":
                return all(self.holds(rest[1], other) for other in self.bindings(rest[0], bound))
            case "exists":
                return any(self.holds(rest[1], other) for other in self.bindings(rest[0], bound))
            case "=":
                return bound.get(rest[0], rest[0]) == bound.get(rest[1], rest[1])
        fact = (head, *(bound.get(name, name) for name in rest))
        if head in self.rules:
            names, body = self.rules[head]
            return self.holds(body, dict(zip(names, fact[1:], strict=True)))
        return fact in self.facts

    def change(self, part, bound, added, deleted):
        match part:
            case [] | ["increase", *_]:
                return
            case ["and", *rest]:
                for one in rest:
                    self.change(one, bound, added, deleted)
            case ["when", condition, then]:
                if self.holds(condition, bound):
                    self.change(then, bound, added, deleted)
            case ["forall", variables, then]:
                for other in self.bindings(variables, bound):
                    self.change(then, other, added, deleted)
            case ["not", [head, *rest]]:
                deleted.add((head, *(bound.get(name, name) for name in rest)))
            case [head, *rest]:
                added.add((head, *(bound.get(name, name) for name in rest)))

    def do(self, action, *arguments):
        """Carry out an action, or say why it cannot be."""
        if action not in self.actions:
            raise ReplayError(f"no action {action}")
        one = self.actions[action]
        named = typed(one.get(":parameters", []))
        if len(named) != len(arguments):
            raise ReplayError(f"{action} takes {len(named)} arguments")
        if not all(self.fits(name, types) for name, (_, types) in zip(arguments, named, strict=True)):
            raise ReplayError(f"({action} {' '.join(arguments)}): a type does not fit")
        bound = dict(zip([name for name, _ in named], arguments, strict=True))
        if not self.holds(one.get(":precondition", []), bound):
            raise ReplayError(f"({action} {' '.join(arguments)}) does not apply")
        added, deleted = set(), set()
        self.change(one.get(":effect", []), bound, added, deleted)
        self.facts = (self.facts - deleted) | added

    def reached(self):
        """Whether the goal holds."""
        return self.holds(self.goal, {})


def replay(domain, problem, lines):
    """Run the steps of a plan (`(action a b)`) and return whether the goal holds at the end."""
    world = World(domain, problem)
    for line in lines:
        if line.strip() and not line.startswith(";"):
            world.do(*line.strip("() \n").split())
    return world.reached()
