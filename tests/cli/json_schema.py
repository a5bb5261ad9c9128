"""Whether a JSON value fits a JSON schema (2020-12): the keywords that Kestrel's schemas use, no others."""
import re

TYPES = {
    "object": lambda v: isinstance(v, dict),
    "array": lambda v: isinstance(v, list),
    "string": lambda v: isinstance(v, str),
    "boolean": lambda v: isinstance(v, bool),
    "integer": lambda v: isinstance(v, int) and not isinstance(v, bool),
    "number": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool),
}
NOTES = {"$schema", "$defs", "title", "description", "default", "ports"}


def misfits(value, schema, root=None, place="$"):
    """What does not fit, one text each; empty if the value fits."""
    root = schema if root is None else root
    found = []

    def no(reason):
        found.append(f"{place}: {reason}")

    def fits(part, item=value):
        return not misfits(item, part, root, place)

    for key, rule in schema.items():
        if key in NOTES or key == "then":
            continue
        if key == "$ref":
            target = root
            for step in rule.removeprefix("#/").split("/"):
                target = target[step]
            found += misfits(value, target, root, place)
        elif key == "type":
            names = [rule] if isinstance(rule, str) else rule
            if not any(TYPES[name](value) for name in names):
                no(f"is no {' or '.join(names)}")
        elif key == "const":
            if value != rule:
                no(f"is not {rule}")
        elif key == "enum":
            if value not in rule:
                no(f"{value!r} is none of {rule}")
        elif key == "anyOf":
            if not any(fits(part) for part in rule):
                no("fits no alternative")
        elif key == "oneOf":
            if sum(fits(part) for part in rule) != 1:
                no("does not fit exactly one alternative")
        elif key == "not":
            if fits(rule):
                no("is excluded")
        elif key == "allOf":
            for part in rule:
                found += misfits(value, part, root, place)
        elif key == "if":
            if fits(rule) and "then" in schema:
                found += misfits(value, schema["then"], root, place)
        elif key in ("minimum", "maximum"):
            if TYPES["number"](value) and (value < rule if key == "minimum" else value > rule):
                no(f"{value} is beyond the {key} {rule}")
        elif key in ("exclusiveMinimum", "exclusiveMaximum"):
            low = key == "exclusiveMinimum"
            if TYPES["number"](value) and (value <= rule if low else value >= rule):
                no(f"{value} is not within the {key} {rule}")
        elif key in ("minLength", "maxLength", "minItems", "maxItems", "minProperties"):
            kind = {"Length": str, "Items": list, "Properties": dict}[key[3:]]
            if isinstance(value, kind) and (len(value) < rule if key.startswith("min") else len(value) > rule):
                no(f"has {len(value)} elements, {key} is {rule}")
        elif key == "pattern":
            if isinstance(value, str) and not re.search(rule, value):
                no(f"{value!r} does not match {rule}")
        elif key == "prefixItems":
            for i, item in enumerate(value[:len(rule)] if isinstance(value, list) else []):
                found += misfits(item, rule[i], root, f"{place}[{i}]")
        elif key == "items":
            for i, item in enumerate(value if isinstance(value, list) else []):
                found += misfits(item, rule, root, f"{place}[{i}]")
        elif key == "required":
            for name in rule:
                if isinstance(value, dict) and name not in value:
                    no(f"lacks '{name}'")
        elif key == "properties":
            for name, item in (value.items() if isinstance(value, dict) else []):
                if name in rule:
                    found += misfits(item, rule[name], root, f"{place}.{name}")
        elif key == "additionalProperties":
            for name, item in (value.items() if isinstance(value, dict) else []):
                if name in schema.get("properties", {}):
                    continue
                if rule is False:
                    no(f"has the unknown key '{name}'")
                else:
                    found += misfits(item, rule, root, f"{place}.{name}")
        elif key == "propertyNames":
            for name in value if isinstance(value, dict) else []:
                found += misfits(name, rule, root, f"{place}.{name} (its name)")
        else:
            raise AssertionError(f"the schema uses '{key}', which is not known here")
    return found
