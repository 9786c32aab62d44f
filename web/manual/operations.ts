// SPDX-License-Identifier: Apache-2.0
// The reference of the HTTP interface in the manual: the operations and objects of
// server/http/openapi.json as Markdown. The server serves the same file.

import { readFileSync } from 'node:fs';

interface Schema {
  $ref?: string;
  type?: string | string[];
  description?: string;
  enum?: (string | number)[];
  const?: string;
  default?: string | number;
  minimum?: number;
  exclusiveMinimum?: number;
  maximum?: number;
  minItems?: number;
  maxItems?: number;
  items?: Schema;
  anyOf?: Schema[];
  properties?: Record<string, Schema>;
  required?: string[];
}

interface Parameter {
  $ref?: string;
  name: string;
  in: string;
  description: string;
  required?: boolean;
  schema: Schema;
}

type Content = Record<string, { schema?: Schema }>;

interface Answer {
  $ref?: string;
  description?: string;
  content?: Content;
}

interface Operation {
  tags: string[];
  operationId: string;
  summary: string;
  description?: string;
  parameters?: Parameter[];
  requestBody?: { description: string; required: boolean; content: Content };
  responses: Record<string, Answer>;
  'x-kerf-right': string;
  'x-kerf-body-bytes-max'?: number;
}

export interface OpenApi {
  tags: { name: string; description: string }[];
  paths: Record<string, Record<string, Operation>>;
  components: {
    parameters: Record<string, Parameter>;
    responses: Record<string, Answer>;
    schemas: Record<string, Schema>;
  };
}

const FILE = new URL('../../server/http/openapi.json', import.meta.url);

export function readOpenApi(): OpenApi {
  return JSON.parse(readFileSync(FILE, 'utf8')) as OpenApi;
}

/** The value to which a reference within the document leads; undefined if there is none. */
export function referenced(api: OpenApi, reference: string): unknown {
  return reference
    .replace(/^#\//, '')
    .split('/')
    .reduce<unknown>((at, name) => (at as Record<string, unknown> | undefined)?.[name], api);
}

/** A value with its reference resolved; its own fields take precedence. */
function resolved<T extends { $ref?: string }>(api: OpenApi, value: T): T {
  if (value.$ref === undefined) return value;
  return { ...(referenced(api, value.$ref) as T), ...value };
}

const code = (text: string | number): string => `\`${text}\``;

const table = (head: string, rows: readonly string[][]): string =>
  rows.length === 0
    ? ''
    : [head, head.replace(/[^|]+/g, '---'), ...rows.map((row) => `| ${row.join(' | ')} |`)].join(
        '\n',
      ) + '\n\n';

function range(schema: Schema): string {
  const { minimum, exclusiveMinimum, maximum } = schema;
  if (minimum !== undefined && maximum !== undefined) return ` from ${minimum} to ${maximum}`;
  const above = exclusiveMinimum !== undefined ? ` above ${exclusiveMinimum}` : '';
  const least = minimum !== undefined ? ` from ${minimum}` : '';
  return `${above}${least}${maximum !== undefined ? `, at most ${maximum}` : ''}`;
}

function listText(schema: Schema): string {
  const { minItems, maxItems, items = {} } = schema;
  const isExact = maxItems !== undefined && minItems === maxItems;
  const most = maxItems !== undefined && !isExact ? `, at most ${maxItems}` : '';
  return `${nameOf(items)}[${isExact ? maxItems : ''}]${range(items)}${most}`;
}

/** The type of a value, without its range. */
function nameOf(schema: Schema): string {
  if (schema.$ref !== undefined) {
    const name = schema.$ref.split('/').pop()!;
    return `[${name}](#${name.toLowerCase()})`;
  }
  return Array.isArray(schema.type) ? schema.type.join(' or ') : (schema.type ?? 'any');
}

/** The type of a value in words. */
function typeText(schema: Schema): string {
  if (schema.anyOf) return schema.anyOf.map(typeText).join(' or ');
  if (schema.const !== undefined) return code(schema.const);
  if (schema.enum) return schema.enum.map(code).join(', ');
  return schema.type === 'array' ? listText(schema) : nameOf(schema) + range(schema);
}

/** The objects of a schema that are described in place. */
function objectsIn(schema: Schema): Schema[] {
  if (schema.$ref !== undefined) return [];
  if (schema.properties) return [schema];
  return [...(schema.anyOf ?? []), ...(schema.items ? [schema.items] : [])].flatMap(objectsIn);
}

/** A row for each field, also of the objects within. */
function fieldRows(schema: Schema, before = ''): string[][] {
  return Object.entries(schema.properties ?? {}).flatMap(([name, field]) => {
    const path = before + name;
    const isOptional = !(schema.required ?? []).includes(name);
    const type = typeText(field) + (isOptional ? ', optional' : '');
    const row = [code(path), type, field.description ?? ''];
    const suffix = field.type === 'array' ? '[].' : '.';
    return [row, ...objectsIn(field).flatMap((within) => fieldRows(within, path + suffix))];
  });
}

function parameterRows(api: OpenApi, operation: Operation): string[][] {
  return (operation.parameters ?? [])
    .map((parameter) => resolved(api, parameter))
    .map(({ name, in: place, required, schema, description }) => {
      const isList = schema.type === 'array';
      const values = isList ? `${typeText(schema)}, separated by commas` : typeText(schema);
      const otherwise = schema.default === undefined ? '' : `, default ${code(schema.default)}`;
      const need = place === 'query' && required ? ', required' : '';
      return [code(name), place, values + otherwise + need, description];
    });
}

/** The content of a request or an answer: its types, and the schema unless it is plain text. */
function contentText(content: Content | undefined): string {
  return Object.entries(content ?? {})
    .map(([type, { schema }]) => {
      if (type !== 'application/json' || !schema) return code(type);
      return schema.properties ? 'JSON' : typeText(schema);
    })
    .join(', ');
}

/** The answers but those that every operation has. */
function answerRows(api: OpenApi, operation: Operation): string[][] {
  return Object.entries(operation.responses)
    .filter(([, { $ref, description }]) => $ref === undefined || description !== undefined)
    .flatMap(([status, given]) => {
      const answer = resolved(api, given);
      const isError = Number(status) >= 400;
      const row = [code(status), isError ? '' : contentText(answer.content), answer.description!];
      const schema = answer.content?.['application/json']?.schema;
      const fields = !isError && schema?.properties ? fieldRows(schema) : [];
      return [row, ...fields.map(([name, type, text]) => [name!, type!, text!])];
    });
}

const bytesText = (bytes: number): string => `${bytes / 2 ** 20} MB`;

function operationText(api: OpenApi, method: string, path: string, operation: Operation): string {
  const heading = code(`${method.toUpperCase()} ${path}`);
  const more = operation.description === undefined ? '' : ` ${operation.description}`;
  const lines = [`### ${heading}`, '', `${operation.summary}.${more}`];
  lines.push('', `Right: ${code(operation['x-kerf-right'])}.`);
  const body = operation.requestBody;
  if (body) {
    const limit = bytesText(operation['x-kerf-body-bytes-max'] ?? 0);
    lines.push('', `Body, up to ${limit}: ${contentText(body.content)}. ${body.description}`);
  }
  lines.push('', table('| parameter | in | value | meaning |', parameterRows(api, operation)));
  lines.push(table('| answer | content | meaning |', answerRows(api, operation)));
  return lines.join('\n');
}

function objectText(name: string, schema: Schema): string {
  const type = schema.properties ? '' : `Type: ${typeText(schema)}.\n\n`;
  const fields = table('| field | type | meaning |', fieldRows(schema));
  return `### ${name}\n\n${schema.description ?? ''}\n\n${type}${fields}`;
}

/** The operations, a section for each tag, then the objects in their answers. */
export function operationsMarkdown(api: OpenApi): string {
  const all = Object.entries(api.paths).flatMap(([path, operations]) =>
    Object.entries(operations).map(([method, operation]) => ({ method, path, operation })),
  );
  const sections = api.tags.map(({ name, description }) => {
    const texts = all
      .filter(({ operation }) => operation.tags.includes(name))
      .map(({ method, path, operation }) => operationText(api, method, path, operation));
    return `## ${name}\n\n${description}\n\n${texts.join('\n')}`;
  });
  const objects = Object.entries(api.components.schemas).map(([name, schema]) =>
    objectText(name, schema),
  );
  return [...sections, '## Objects\n', ...objects].join('\n');
}
