"""What may stand in what, and in which order: of LIDO 1.1 and OAI-PMH 2.0, written down from their specifications.

Only the elements this hall writes are named: any other one is a fault. LIDO's is from lido-v1.1.xsd (ICOM-CIDOC LIDO
Working Group), OAI-PMH's from the protocol's own document.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

XML = "{http://www.w3.org/XML/1998/namespace}"
LIDO = "{http://www.lido-schema.org}"
OAI = "{http://www.openarchives.org/OAI/2.0/}"
CONCEPT = "conceptID* term*"
NOTE = "descriptiveNoteID* descriptiveNoteValue* sourceDescriptiveNote*"
RIGHTS = "rightsType* rightsDate? rightsHolder* creditLine*"
LEGAL_BODY = "legalBodyID* legalBodyName* legalBodyWeblink*"

# Element -> its children, as a regular expression over their names; "" holds text.
LIDO_CHILDREN = {
    "lidoWrap": "lido+",
    "lido": "lidoRecID+ objectPublishedID* category? applicationProfile? descriptiveMetadata+ administrativeMetadata+",
    "category": CONCEPT,
    "descriptiveMetadata": "objectClassificationWrap objectIdentificationWrap eventWrap? objectRelationWrap?",
    "objectClassificationWrap": "objectWorkTypeWrap classificationWrap?",
    "objectWorkTypeWrap": "objectWorkType+",
    "objectWorkType": CONCEPT,
    "objectIdentificationWrap": "titleWrap inscriptionsWrap? repositoryWrap? displayStateEditionWrap?"
    " objectDescriptionWrap? objectMeasurementsWrap? objectMaterialsTechWrap?",
    "titleWrap": "titleSet+",
    "titleSet": "appellationValue+ sourceAppellation*",
    "repositoryWrap": "repositorySet*",
    "repositorySet": "displayRepository* repositoryName? workID* repositoryLocation? sourceRepositorySet*",
    "repositoryName": LEGAL_BODY,
    "legalBodyName": "appellationValue+ sourceAppellation*",
    "objectDescriptionWrap": "objectDescriptionSet*",
    "objectDescriptionSet": NOTE + " objectDescriptionRights*",
    "objectMeasurementsWrap": "objectMeasurementsSet*",
    "objectMeasurementsSet": "displayObjectMeasurements* objectMeasurements?",
    "objectMaterialsTechWrap": "objectMaterialsTechSet*",
    "objectMaterialsTechSet": "displayMaterialsTech* materialsTech*",
    "eventWrap": "eventSet*",
    "eventSet": "displayEvent* event?",
    "event": "eventID* eventType roleInEvent* eventName* eventActor* culture* eventDate? periodName* eventPlace*",
    "eventType": CONCEPT,
    "eventActor": "displayActorInRole* actorInRole?",
    "culture": CONCEPT,
    "eventDate": "displayDate* date?",
    "administrativeMetadata": "rightsWorkWrap? recordWrap resourceWrap?",
    "rightsWorkWrap": "rightsWorkSet*",
    "rightsWorkSet": RIGHTS,
    "rightsType": CONCEPT,
    "recordWrap": "recordID+ recordType recordSource+ recordRights* recordInfoSet* collection*",
    "recordType": CONCEPT,
    "recordSource": LEGAL_BODY,
    "recordRights": RIGHTS,
    "recordInfoSet": "recordInfoID* recordInfoLink* recordMetadataDate*",
    "resourceWrap": "resourceSet*",
    "resourceSet": "resourceID* resourceRepresentation* resourceType? resourceRelType* resourcePerspective*"
    " resourceDescription* resourceDateTaken? resourceSource* rightsResource*",
    "resourceRepresentation": "linkResource resourceMeasurementsSet*",
    "resourceType": CONCEPT,
    "rightsResource": RIGHTS,
}
LIDO_TEXTS = {"lidoRecID", "objectPublishedID", "conceptID", "recordID", "term", "appellationValue", "workID"}
LIDO_TEXTS |= {
    "legalBodyWeblink",
    "descriptiveNoteValue",
    "displayObjectMeasurements",
    "displayMaterialsTech",
}
LIDO_TEXTS |= {"displayActorInRole", "displayDate", "creditLine", "recordInfoLink", "recordMetadataDate"}
LIDO_TEXTS |= {"linkResource", "resourceDescription"}
IDENTIFIERS = {"lidoRecID", "objectPublishedID", "conceptID", "recordID"}  # their type is required
LISTED = "resumptionToken?"
OAI_CHILDREN = {
    "OAI-PMH": "responseDate request"
    " (error+ |Identify|ListMetadataFormats|ListSets|ListIdentifiers|ListRecords|GetRecord)",
    "Identify": "repositoryName baseURL protocolVersion adminEmail+ earliestDatestamp deletedRecord granularity"
    " compression* description*",
    "ListMetadataFormats": "metadataFormat+",
    "metadataFormat": "metadataPrefix schema metadataNamespace",
    "ListSets": "set+ " + LISTED,
    "set": "setSpec setName setDescription*",
    "ListIdentifiers": "header+ " + LISTED,
    "ListRecords": "record+ " + LISTED,
    "GetRecord": "record",
    "record": "header metadata? about*",
    "header": "identifier datestamp setSpec*",
}
OAI_TEXTS = {"responseDate", "request", "error", "repositoryName", "baseURL", "protocolVersion", "adminEmail"}
OAI_TEXTS |= {
    "earliestDatestamp",
    "deletedRecord",
    "granularity",
    "metadataPrefix",
    "schema",
    "metadataNamespace",
}
OAI_TEXTS |= {"setSpec", "setName", "identifier", "datestamp", "resumptionToken"}


def lido_faults(root: Any) -> list[str]:
    """What LIDO 1.1 does not allow below `root`, an element of lxml."""
    found = list(_faults(root, LIDO, LIDO_CHILDREN, LIDO_TEXTS))
    for element in root.iter(LIDO + "*"):
        name = element.tag.removeprefix(LIDO)
        if name in IDENTIFIERS and not element.get(f"{LIDO}type"):
            found.append(f"{name} has no type")
        if name in ("descriptiveMetadata", "administrativeMetadata") and not element.get(f"{XML}lang"):
            found.append(f"{name} has no language")
    return found


def oai_faults(root: Any) -> list[str]:
    """What OAI-PMH 2.0 does not allow, what stands in `metadata` left out."""
    return list(_faults(root, OAI, OAI_CHILDREN, OAI_TEXTS))


def _faults(element: Any, space: str, children: dict[str, str], texts: set[str]) -> Iterator[str]:
    name = element.tag.removeprefix(space)
    if name == "metadata" and space == OAI:
        if len(element) != 1:
            yield f"metadata holds {len(element)} elements"
        return
    inside = "".join(child.tag.removeprefix(space) + " " for child in element)
    if name in texts:
        if inside or not (element.text or name == "resumptionToken"):
            yield f"{name} is no text"
    elif name not in children:
        yield f"{name} is unknown"
    elif not re.fullmatch(_pattern(children[name]), inside):
        yield f"{name} holds {inside}"
    for child in element:
        yield from _faults(child, space, children, texts)


def _pattern(model: str) -> str:
    """A regular expression over names, each with a space behind it."""
    return re.sub(r"([A-Za-z-]+)([?*+]?) ?", r"(?:\1 )\2", model)
