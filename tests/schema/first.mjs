// The first error of a document by the order that solver/job/schema.h documents, from the errors
// that ajv reports in its own order.
//
// ajv is given the schema with every oneOf replaced by the keyword x-choose: the branch is chosen
// by the type of the value, or by the property with a const in which objects differ, and only it
// is checked. So all errors that are reported are about the form that was meant. Of them the first
// is: at a value its own keywords, then the choice of a branch, the number of members, members of
// no known name in the order of the document, their names, missing keys, the number of items,
// then the members in the order of the schema, and the items; all of one before the next.

export const escape = (key) => key.replaceAll('~', '~0').replaceAll('/', '~1');

const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);

export function hasType(value, type) {
  switch (type) {
    case 'object': return isObject(value);
    case 'array': return Array.isArray(value);
    case 'integer': return Number.isInteger(value);
    default: return typeof value === type;
  }
}

export function resolve(root, node) {
  while (node.$ref) {
    const { $ref, ...own } = node;
    node = { ...root.$defs[$ref.slice('#/$defs/'.length)], ...own };
  }
  return node;
}

const discriminator = (branch) =>
  Object.entries(branch.properties ?? {}).find(([, property]) => 'const' in property)?.[0];

// { branch } or, when there is none, { at }: the key to which the value owes it, null for itself.
export function choose(root, branches, value) {
  const forms = branches.map((branch) => resolve(root, branch));
  const quantity = forms.find((form) => 'x-unit' in form);
  const fitting = forms.filter((form) => 'const' in form
    ? typeof form.const === typeof value : !form.type || hasType(value, form.type));
  if (typeof value === 'number' && quantity) {
    return { branch: fitting[0]?.const === value ? fitting[0] : quantity };
  }
  if (fitting.length === 0) {
    return { at: null };
  }
  const key = isObject(value) ? discriminator(fitting[0]) : undefined;
  if (!key) {
    return { branch: fitting[0] };
  }
  const chosen = fitting.find((form) => form.properties[key]?.const === value[key]);
  return chosen ? { branch: chosen } : { at: key in value ? key : null };
}

const late = new Set(['maxProperties', 'additionalProperties', 'propertyNames', 'required',
  'minItems', 'maxItems', 'x-choose']);

export function firstPointer(root, errors, document) {
  const at = (path) => errors.filter((error) => error.instancePath === path &&
    error.propertyName === undefined);

  function locate(path, schema, value) {
    let node = resolve(root, schema);
    const here = at(path);
    if (here.some((error) => !late.has(error.keyword))) {
      return path;
    }
    const choice = here.find((error) => error.keyword === 'x-choose');
    if (choice) {
      return choice.params.at === null ? path : `${path}/${escape(choice.params.at)}`;
    }
    while (node.oneOf) {
      node = resolve(root, choose(root, node.oneOf, value).branch);
    }
    const has = (keyword) => here.some((error) => error.keyword === keyword);
    if (has('maxProperties')) {
      return path;
    }
    if (isObject(value)) {
      const known = node.properties ?? {};
      for (const [key, member] of Object.entries(value)) {
        if (Object.hasOwn(known, key)) {
          continue;
        }
        const child = `${path}/${escape(key)}`;
        if (here.some((error) => error.params.additionalProperty === key)) {
          return child;
        }
        const inside = isObject(node.additionalProperties)
          ? locate(child, node.additionalProperties, member) : null;
        if (inside !== null) {
          return inside;
        }
      }
      for (const key of Object.keys(value)) {
        if (here.some((error) => error.params.propertyName === key)) {
          return `${path}/${escape(key)}`;
        }
      }
    }
    if (has('required') || has('minItems') || has('maxItems')) {
      return path;
    }
    const children = isObject(value)
      ? Object.entries(node.properties ?? {}).filter(([key]) => Object.hasOwn(value, key))
        .map(([key, child]) => [key, child, value[key]])
      : Array.isArray(value) && node.items ? value.map((item, i) => [String(i), node.items, item])
        : [];
    for (const [key, child, member] of children) {
      const inside = locate(`${path}/${escape(key)}`, child, member);
      if (inside !== null) {
        return inside;
      }
    }
    return null;
  }
  return locate('', root, document);
}
